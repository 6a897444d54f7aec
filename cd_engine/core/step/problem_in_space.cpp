#include "step/problem_in_space.hpp"

#include <cassert>

namespace cd {
namespace {

	constexpr double pushedOut = 1e-9; // of a sphere's radius: smaller overlaps are round-off and stay
	constexpr double coneFactor = 1 + 1e-9; // as in the plane

	// The friction that a contact has carried, turned with the contact: with its normal, and about it as its two bodies turn on average.
	Vector3 frictionNow(const StepView<Space3>& step, const Pair& pair, const SpaceCarried& carried, const Vector3& n)
	{
		const Vector3 friction = carried.frictionAcross(n);
		const double twist = 0.5 * step.dt() * dot(n, spinOf(step.world.bodies[pair.a]) + spinOf(step.world.bodies[pair.b]));
		return twist == 0 ? friction : rotated(friction, twist * n);
	}

	// The impulse that a contact has carried, within the present friction cone.
	SpatialComponents<double> guess(const StepView<Space3>& step, std::size_t index, const Vector3& n)
	{
		const SpaceCarried& carried = step.world.carried[index];
		const double normal = step.settings.warmStart && carried.any() ? step.dt() * carried.normalForce() : 0;
		if (!(normal > 0))
			return { 0, 0, 0, 0 };
		const Vector3 t = step.dt() * frictionNow(step, step.world.pairs[index], carried, n);
		const double most = step.world.pairs[index].mu * normal, size = length(t), share = size > most * coneFactor ? most / size : 1;
		return { normal, share * t.x, share * t.y, share * t.z };
	}

	// Gives a row the stiffness of its pair (contact_system.hpp).
	void soften(const StepView<Space3>& step, std::size_t pair, double gap, ContactRow<Space3>& c)
	{
		const auto [kn, kt] = step.world.stiffnesses[pair];
		const double h = step.dt(),
			     dashpot = step.settings.dampingRatio > 0 && c.wnn > 0 ? 2 * step.settings.dampingRatio * std::sqrt(kn / c.wnn) : 0;
		const double resists = kn * h + dashpot;
		c.bias = kn * gap / resists;
		c.cn = 1 / (h * resists);
		c.ct = kt > 0 ? 1 / (kt * h * h) : 0;
		const SpaceCarried& carried = step.world.carried[pair];
		const Vector3 held = carried.normalForce() > 0 ? -c.ct * h * frictionNow(step, step.world.pairs[pair], carried, { c.nx, c.ny, c.nz })
							       : Vector3 { 0, 0, 0 };
		c.slipX = held.x;
		c.slipY = held.y;
		c.slipZ = held.z;
		if (!(kt > 0))
			c.mu = c.px = c.py = c.pz = 0;
	}

	// Of a sphere: from its centre to the contact [m].
	double armOf(const StepView<Space3>& step, int32_t body, double overlap)
	{
		const BodyVelocity<Space3>& b = step.bodies[body];
		const bool still = std::all_of(b.w + 3, b.w + 6, [](double w) { return w == 0; })
		    && std::all_of(b.v + 3, b.v + 6, [](double v) { return v == 0; });
		return isBoundary(step.place(body)) || still ? 0 : step.place(body).radius - 0.5 * overlap;
	}

} // namespace

void ProblemBuilder<Space3>::addPoints(
    const StepView<Space3>& step, const ContactFinder<Space3>& finder, ContactSystem<Space3>& system, std::size_t first)
{
	if (first == 0)
		pointOf.clear();
	if (!step.motion.anyTurns())
		return;
	pointOf.resize(finder.pairs().size(), -1);
	for (std::size_t i = first; i < pointOf.size(); i++) {
		const int32_t a = step.world.pairs[finder.pairs()[i]].a;
		if (!step.turningBoundary(a))
			continue;
		pointOf[i] = static_cast<int32_t>(system.bodies.size());
		const SpaceBody& boundary = step.world.bodies[a];
		const Vector3 at = finder.touch(step, finder.pairs()[i]).c, v = velocityAt(boundary, at - step.place(a).at);
		BodyVelocity<Space3> point {};
		std::copy_n(boundary.v, Space3::freedoms, point.v); // with its spin: who looks for the motion of the whole boundary finds it
		point.v[0] = v.x;
		point.v[1] = v.y;
		point.v[2] = v.z;
		system.bodies.push_back(point);
		system.places.push_back({ at.x, at.y, at.z });
	}
}

ContactRow<Space3> ProblemBuilder<Space3>::makeRow(const StepView<Space3>& step, const ContactFinder<Space3>& finder, std::size_t contact)
{
	const auto index = static_cast<std::size_t>(finder.pairs()[contact]);
	const Pair& pair = step.world.pairs[index];
	const SpaceTouch touch = finder.touch(step, index);
	const double gap = finder.gap(step.world, index), turned = step.turning(pair, touch.n, gap);
	const double radius = step.smallerRadius(pair), allowed = step.settings.allowedOverlap * radius;
	const bool pushes = !step.world.compliant() && gap < -std::max(pushedOut, step.settings.allowedOverlap) * radius;
	ContactRow<Space3> c;
	c.a = pointOf.empty() || pointOf[contact] < 0 ? pair.a : pointOf[contact];
	c.b = pair.b;
	c.nx = touch.n.x;
	c.ny = touch.n.y;
	c.nz = touch.n.z;
	c.at = armOf(step, pair.a, touch.overlap);
	c.bt = armOf(step, pair.b, touch.overlap);
	c.bias = ((gap > 0 ? gap : pushes ? step.settings.gapCorrection * (gap + allowed) : 0) + turned) / step.dt();
	c.mu = pair.mu;
	setImpulse(c, guess(step, index, touch.n));
	c.assembleBlock(step.bodies[c.a], step.bodies[c.b]);
	if (step.world.compliant())
		soften(step, index, gap + turned, c);
	if (!(c.wnn > 0))
		setImpulse(c, { 0, 0, 0, 0 });
	if (step.settings.restitution > 0)
		demandRebound(step, finder, contact, c, turned);
	return c;
}

void ProblemBuilder<Space3>::demandRebound(
    const StepView<Space3>& step, const ContactFinder<Space3>& finder, std::size_t contact, ContactRow<Space3>& c, double turned)
{
	const auto count = static_cast<int32_t>(step.world.bodies.size());
	const double* const a = c.a < count ? step.world.bodies[c.a].v : step.bodies[c.a].v;
	const double un = relativeVelocity<false>(c, motionOf<Space3>(a), motionOf<Space3>(step.world.bodies[c.b].v)).n;
	const int32_t pair = finder.pairs()[contact];
	c.bias = rebounds.demand(contact, step, pair, { finder.gap(step.world, pair), turned, un }, c);
}

void ProblemBuilder<Space3>::fill(const StepView<Space3>& step, const ContactFinder<Space3>& finder, ContactSystem<Space3>& system, std::size_t first)
{
	addPoints(step, finder, system, first);
	std::vector<ContactRow<Space3>>& rows = system.contacts.all();
	forRanges(&step.threads, rows.size() - first, [&](std::size_t from, std::size_t to) {
		for (std::size_t i = first + from; i < first + to; i++)
			rows[i] = makeRow(step, finder, i);
	});
}

void ProblemBuilder<Space3>::build(const StepView<Space3>& step, const ContactFinder<Space3>& finder, ContactSystem<Space3>& system, bool same, bool)
{
	assert(system.bodies.size() == step.world.bodies.size() && step.world.carried.size() == step.world.pairs.size());
	system.contactSet += !same;
	rebounds.restart(step, step.settings.restitution > 0 ? finder.pairs().size() : 0);
	system.contacts.resize(finder.pairs().size());
	fill(step, finder, system, 0);
}

void ProblemBuilder<Space3>::append(const StepView<Space3>& step, const ContactFinder<Space3>& finder, ContactSystem<Space3>& system)
{
	assert(step.settings.restitution == 0);
	system.contactSet++;
	const std::size_t before = system.contacts.size();
	system.contacts.resize(finder.pairs().size());
	fill(step, finder, system, before);
	for (std::size_t i = before; i < system.contacts.size(); i++) {
		ContactRow<Space3>& c = system.contacts[i];
		const double un = relativeVelocity(c, system.bodies[c.a], system.bodies[c.b]).n;
		setImpulse(c, { c.wnn > 0 ? std::max(0., -(un + c.bias) / c.nn()) : 0, 0, 0, 0 });
	}
}

void ProblemBuilder<Space3>::guessAgain(
    const StepView<Space3>& step, const ContactFinder<Space3>& finder, ContactSystem<Space3>& system, bool warm) const
{
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		ContactRow<Space3>& c = system.contacts[i];
		const auto pair = static_cast<std::size_t>(finder.pairs()[i]);
		setImpulse(c,
		    warm && i < finder.foundFirst() && c.wnn > 0 ? guess(step, pair, { c.nx, c.ny, c.nz })
								 : SpatialComponents<double> { 0, 0, 0, 0 });
	}
}

bool ProblemBuilder<Space3>::lowerRebounds(
    const StepView<Space3>& step, ContactSystem<Space3>& system, const SolverReport& report, double tolerance, bool last)
{
	if (!rebounds.any())
		return false;
	if (report.contact >= 0 && report.status != Status::converged && report.status != Status::diverged)
		return rebounds.giveUp(system, report.contact);
	const bool unsolved = report.status == Status::max_iterations || report.status == Status::stagnated;
	return step.settings.gapCorrection == 0 && (report.status == Status::converged || unsolved)
	    && rebounds.lower(system, step.world.bodies, step.dt(), tolerance, step.settings.restitution, unsolved || last);
}

} // namespace cd
