// The springs of a contact with stiffness (contact_system.hpp has the equations). law.inl includes this file; its rules hold.

// k_n, k_t [N/m], normal dashpot c [N s/m], gap [m], and the tangential impulse h f that the contact has carried [N s].
template <class N> struct Springs {
	N kn, kt, dashpot, gap, held;
};
template <class N> LAW N resistanceOf(const Springs<N>& s, double h) { return s.kn * h + s.dashpot; }
template <class N> LAW N biasOf(const Springs<N>& s, double h) { return s.kn * s.gap / resistanceOf(s, h); }
template <class N> LAW Spring<N> yieldOf(const Springs<N>& s, double h)
{
	const N none = {}, t = s.kt > none ? 1 / (s.kt * h * h) : none;
	return { 1 / (h * resistanceOf(s, h)), t, -t * s.held };
}

// The first guess: what the springs reach if the bodies keep the relative velocity u of before the step. p: what the contact has carried, times h;
// ct: as in ContactRow. Where forces change slowly this is the extrapolation 2 f - f_before, and it saves half to two thirds of the sweeps; nothing
// but the state of the scene is needed for it. In collisions it would be far too large, so p_n at most doubles.
template <class N> LAW Components<N> movedOn(const Components<N>& p, const Components<N>& u, const N& kn, const N& ct, double h)
{
	const N none = {}, n = p.n - kn * h * h * u.n;
	return { smaller(larger(n, none), 2 * p.n), p.t - (ct > none ? u.t / ct : none) };
}

// Energies [J]: stored after and before a step, absorbed in it, and of this by the dashpot.
template <class N> struct SpringEnergies {
	N stored, before, absorbed, dashpots;
};
// Of a contact that obeys its law with the impulse p.
template <class N> LAW SpringEnergies<N> energiesOf(const Springs<N>& s, const Components<N>& p, double h)
{
	const N none = {}, overlapBefore = larger(-s.gap, none), overlap = (p.n - s.dashpot * s.gap) / resistanceOf(s, h);
	const Spring<N> yields = yieldOf(s, h);
	const N closing = biasOf(s, h) + yields.n * p.n, slipping = yields.bias + yields.t * p.t;
	const auto loaded = p.n > none;
	return { loaded ? 0.5 * s.kn * overlap * overlap + 0.5 * yields.t * p.t * p.t : none,
		0.5 * s.kn * overlapBefore * overlapBefore + 0.5 * yields.t * s.held * s.held, loaded ? p.n * closing + p.t * slipping : none,
		loaded ? h * s.dashpot * closing * closing : none };
}
