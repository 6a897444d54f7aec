// What holds for a pair of bodies, from their materials and the settings: friction, restitution, stiffness and rolling resistance.
#include "scene_link.hpp"

#include <algorithm>
#include <cmath>

namespace cd_engine {

void PairValues::check() const
{
	en.each([](double e) {
		if (!(e >= 0 && e <= 1))
			throw SceneError(text("ContactDynamics: en has the value ", e, ". Give coefficients of restitution from 0 to 1"));
	});
	frictAngle.each([](double angle) {
		if (!(angle >= 0 && angle < 1.5707963267948966 && std::tan(angle) <= 1e6))
			throw SceneError(
			    text("ContactDynamics: frictAngle has the value ", angle, " rad. Give math.atan(mu) with a mu from 0 to 1e6"));
	});
}

double PairValues::largestRestitution() const
{
	double largest = en.algo == "zero" || en.algo == "val" ? 0 : restitution;
	en.each([&](double e) { largest = std::max(largest, e); });
	return largest;
}

template <class Space> bool SceneLink<Space>::setValues(const PairValues& now)
{
	now.check();
	newValues = newValues || !(now == values);
	values = now;
	return newValues;
}

template <class Space> void SceneLink<Space>::setRestitution()
{
	world.restitutions.resize(values.en.given() ? world.pairs.size() : 0);
	for (std::size_t i = 0; i < world.restitutions.size(); i++)
		world.restitutions[i]
		    = values.en.of(bodies[world.pairs[i].a].material, bodies[world.pairs[i].b].material, values.restitution, values.restitution);
}

template <class Space> void SceneLink<Space>::setPairFriction()
{
	for (cd::Pair& pair : world.pairs) {
		const KnownBody &a = bodies[pair.a], &b = bodies[pair.b];
		pair.mu = std::tan(values.frictAngle.of(a.material, b.material, a.frictionAngle, b.frictionAngle));
	}
}

template <class Space> void SceneLink<Space>::setFriction(cd::Threads& threads)
{
	if (values.frictAngle.given())
		return setPairFriction();
	cd::forRanges(&threads, world.awake.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t k = from; k < to; k++) {
			cd::Pair& pair = world.pairs[world.awake[k]];
			pair.mu = std::min(world.bodies[pair.a].friction, world.bodies[pair.b].friction); // the smaller angle of the two, as YADE
		}
	});
}

// The radius that YADE's functors give to the first body of a pair: of a Facet twice that of the sphere, of other boundaries the same.
template <class Space> double SceneLink<Space>::firstRadius(const cd::Pair& pair) const
{
	const cd::BodyOf<Space>&a = world.bodyOf(pair.a), &b = world.bodyOf(pair.b);
	return !isBoundary(a) ? a.radius : world.shapes[pair.a].kind == cd::ShapeKind::facet ? 2 * b.radius : b.radius;
}

// As YADE's Ip2_FrictMat_FrictMat_FrictPhys, in its order of operations.
template <class Space> cd::Stiffness SceneLink<Space>::stiffnessOf(const cd::Pair& pair) const
{
	if (!stiffness.ofMaterials)
		return { stiffness.kn, stiffness.kt };
	const KnownBody &a = bodies[pair.a], &b = bodies[pair.b];
	const double ra = firstRadius(pair), rb = world.bodyOf(pair.b).radius;
	const double kn = 2 * a.young * ra * b.young * rb / (a.young * ra + b.young * rb);
	const double kt = a.poisson > 0 && b.poisson > 0
	    ? 2 * a.young * ra * a.poisson * b.young * rb * b.poisson / (a.young * ra * a.poisson + b.young * rb * b.poisson)
	    : 0;
	return { kn, kt };
}

// Wakes all islands if a stiffness has changed.
template <class Space> void SceneLink<Space>::setStiffness(Sleepers& sleepers)
{
	constexpr double least = 1e-100; // 1/(k h^2) has to be a number
	const std::size_t count = stiffness.rigid() ? 0 : world.pairs.size();
	bool changed = world.stiffnesses.size() != count;
	world.springs = !stiffness.rigid();
	world.stiffnesses.resize(count);
	for (std::size_t i = 0; i < count; i++) {
		const cd::Stiffness now = stiffnessOf(world.pairs[i]);
		if (!(now.kn > least && std::isfinite(now.kn) && (now.kt == 0 || now.kt > least)))
			throw SceneError(text("ContactDynamics: the contact of bodies #", world.pairs[i].a, " and #", world.pairs[i].b,
			    " has k_n = ", now.kn, " and k_t = ", now.kt, " N/m. Give ", stiffness.ofMaterials ? "materials a young" : "a stiffness",
			    " from which finite ones above ", least, " N/m follow"));
		changed = changed || now.kn != world.stiffnesses[i].kn || now.kt != world.stiffnesses[i].kt;
		world.stiffnesses[i] = now;
	}
	if (changed)
		sleepers.wakeAll(world, { "stiffnesses of contacts have changed", -1 });
}

// As YADE's Ip2_CohFrictMat_CohFrictMat_CohFrictPhys: the smaller one of eta R of the two, and for a boundary the disk's radius.
template <> cd::Rolling SceneLink<cd::Plane>::rollingOf(const cd::Pair& pair) const
{
	const KnownBody &a = bodies[pair.a], &b = bodies[pair.b];
	const double ra = firstRadius(pair), rb = world.bodyOf(pair.b).radius;
	const double kt = stiffness.rigid() ? 0 : stiffnessOf(pair).kt;
	const double alpha = a.alphaKr > 0 && b.alphaKr > 0 ? 2 * a.alphaKr * b.alphaKr / (a.alphaKr + b.alphaKr) : 0;
	return { std::min(a.etaRoll * ra, b.etaRoll * rb), alpha > 0 ? ra * rb * kt * alpha : 0 };
}

// Wakes all islands if the resistance of a pair has changed.
template <> void SceneLink<cd::Plane>::setRolling(cd::Sleepers<cd::Plane>& sleepers)
{
	const std::size_t count = anyRolls ? world.pairs.size() : 0;
	bool changed = world.rollings.size() != count;
	world.rollings.resize(count);
	for (std::size_t i = 0; i < count; i++) {
		const cd::Rolling now = rollingOf(world.pairs[i]);
		changed = changed || !(now == world.rollings[i]);
		world.rollings[i] = now;
	}
	if (changed)
		sleepers.wakeAll(world, { "the rolling resistance of contacts has changed", -1 });
}

template <> void SceneLink<cd::Space3>::setRolling(cd::Sleepers<cd::Space3>&)
{
	throw SceneError("ContactDynamics: the rolling resistance of a CohFrictMat is known in the plane only. Set its momentRotationLaw to False or "
			 "etaRoll to 0, or keep the disks in the plane: O.bodies[i].state.blockedDOFs='zXY'");
}

#define INSTANTIATE(Space)                                                                                                                           \
	template double SceneLink<Space>::firstRadius(const cd::Pair&) const;                                                                        \
	template bool SceneLink<Space>::setValues(const PairValues&);                                                                                \
	template void SceneLink<Space>::setFriction(cd::Threads&);                                                                                   \
	template void SceneLink<Space>::setRestitution();                                                                                            \
	template void SceneLink<Space>::setStiffness(cd::Sleepers<Space>&);
INSTANTIATE(cd::Plane)
INSTANTIATE(cd::Space3)

} // namespace cd_engine
