// law.inl includes this file: its formulas for contacts in space whose normal passes through the centre of every body that can turn. Friction is a
// vector of the world orthogonal to n: no tangents are chosen, and it turns with the contact. W_nt = 0, and W_tt is a multiple of the identity.

LAW double squareRoot(double x) { return __builtin_sqrt(x); }
template <class N> LAW N squareRoot(const N& x)
{
	N root;
	for (unsigned i = 0; i < sizeof(N) / sizeof(double); i++)
		root[i] = __builtin_sqrt(x[i]);
	return root;
}

// Of an impulse or a relative velocity: along n, and what is orthogonal to n.
template <class N> struct SpatialComponents {
	N n, x, y, z;
};
template <class N> LAW SpatialComponents<N> operator-(const SpatialComponents<N>& a, const SpatialComponents<N>& b)
{
	return { a.n - b.n, a.x - b.x, a.y - b.y, a.z - b.z };
}
template <class N> LAW N tangentialSquare(const SpatialComponents<N>& a) { return a.x * a.x + a.y * a.y + a.z * a.z; }
template <class N> LAW N dot(const SpatialComponents<N>& a, const SpatialComponents<N>& b) { return a.n * b.n + (a.x * b.x + a.y * b.y + a.z * b.z); }
template <class N> LAW SpatialComponents<N> extrapolated(const SpatialComponents<N>& p, const SpatialComponents<N>& before, double beta)
{
	return { p.n + beta * (p.n - before.n), p.x + beta * (p.x - before.x), p.y + beta * (p.y - before.y), p.z + beta * (p.z - before.z) };
}

// Of a body: velocity and angular velocity, or the inverses of its masses.
template <class N> struct SpatialMotion {
	N x, y, z, spinX, spinY, spinZ;
};
template <class N> struct SpatialAction {
	N x, y, z, turnX, turnY, turnZ; // the impulse on b, and n x p: its moment for a lever arm of 1
	N armA, armB;
};
// at, bt: from the centres to the contact, both positive.
template <class N> struct SpatialContact {
	static constexpr bool central = true;
	N nx, ny, nz, at, bt;
};

// u = H^T v, without the bias.
template <bool spinsFirst, class N, class Contact>
LAW SpatialComponents<N> relativeVelocity(const Contact& c, const SpatialMotion<N>& a, const SpatialMotion<N>& b)
{
	const N x = b.x - a.x, y = b.y - a.y, z = b.z - a.z, n = c.nx * x + c.ny * y + c.nz * z;
	const N sx = c.at * a.spinX + c.bt * b.spinX, sy = c.at * a.spinY + c.bt * b.spinY, sz = c.at * a.spinZ + c.bt * b.spinZ;
	return { n, x - n * c.nx - (sy * c.nz - sz * c.ny), y - n * c.ny - (sz * c.nx - sx * c.nz), z - n * c.nz - (sx * c.ny - sy * c.nx) };
}

template <class N> LAW N magnitudes(const N& x, const N& y, const N& z) { return absolute(x) + absolute(y) + absolute(z); }
// The sum of the magnitudes of the terms of u.
template <class N, class Contact> LAW N sizeOf(const Contact& c, const N& bias, const SpatialMotion<N>& a, const SpatialMotion<N>& b)
{
	return magnitudes(a.x, a.y, a.z) + magnitudes(b.x, b.y, b.z) + absolute(bias) + c.at * magnitudes(a.spinX, a.spinY, a.spinZ)
	    + c.bt * magnitudes(b.spinX, b.spinY, b.spinZ);
}

// H p
template <class N, class Contact> LAW SpatialAction<N> actionOf(const Contact& c, const SpatialComponents<N>& p)
{
	return { c.nx * p.n + p.x, c.ny * p.n + p.y, c.nz * p.n + p.z, c.ny * p.z - c.nz * p.y, c.nz * p.x - c.nx * p.z, c.nx * p.y - c.ny * p.x,
		c.at, c.bt };
}

// v += M^-1 H p
template <class N, class V, class W> LAW void push(const SpatialAction<N>& of, V&& a, const W& wa, V&& b, const W& wb)
{
	a.x -= wa.x * of.x;
	a.y -= wa.y * of.y;
	a.z -= wa.z * of.z;
	a.spinX -= wa.spinX * (of.armA * of.turnX);
	a.spinY -= wa.spinY * (of.armA * of.turnY);
	a.spinZ -= wa.spinZ * (of.armA * of.turnZ);
	b.x += wb.x * of.x;
	b.y += wb.y * of.y;
	b.z += wb.z * of.z;
	b.spinX -= wb.spinX * (of.armB * of.turnX);
	b.spinY -= wb.spinY * (of.armB * of.turnY);
	b.spinZ -= wb.spinZ * (of.armB * of.turnZ);
}

// How much the magnitude of an impulse acts on a body of unit mass.
template <class N> LAW N actingOn(const N& t, const SpatialComponents<N>& p)
{
	const N across = squareRoot(tangentialSquare(p));
	return absolute(p.n) + across + t * t * across;
}

// p_n >= 0, and the friction scaled into the disk |p_t| <= mu p_n. This solves the contact exactly.
template <class N> LAW SpatialComponents<N> cut(const SpatialComponents<N>& p, const Friction<N>& by)
{
	const N n = larger(p.n, N {}), limit = by.mu * n, square = tangentialSquare(p), one = N {} + 1;
	const N scale = square > limit * limit ? limit / squareRoot(square) : one;
	return { n, scale * p.x, scale * p.y, scale * p.z };
}

// |p - P_K(p - (u + mu |u_t| n)/W_nn)|^2, K Coulomb's circular cone.
template <class N, class W> LAW N squaredMiss(const SpatialComponents<N>& p, const SpatialComponents<N>& u, const Friction<N>& by, const W& wnn)
{
	const N none = {}, one = none + 1;
	const SpatialComponents<N> z = { p.n - over<N>(u.n + by.mu * squareRoot(tangentialSquare(u)), wnn), p.x - over<N>(u.x, wnn),
		p.y - over<N>(u.y, wnn), p.z - over<N>(u.z, wnn) };
	const N length = squareRoot(tangentialSquare(z)), along = (z.n + by.mu * length) / (1 + by.mu * by.mu);
	const auto inside = (z.n >= none) & (length <= by.mu * z.n), behind = by.mu * length <= -z.n;
	const N scale = inside ? one : behind ? none : by.mu * along / (length > none ? length : one);
	const SpatialComponents<N> nearest = { inside ? z.n : behind ? none : along, scale * z.x, scale * z.y, scale * z.z };
	return dot(p - nearest, p - nearest);
}
