#include "step/finder_in_space.hpp"
#include "search/search.hpp"

#include <cassert>
#include <utility>

namespace cd {
namespace {

	using namespace contact_limits;

	constexpr uint8_t facetAhead = 2; // of a contact: with a facet around a concave edge

	SpaceMeeting meet(const SpacePlace& a, const SpacePlace& b, const SpaceShape& shape)
	{
		const SpaceFoot foot = locateFoot(a, b, shape);
		return { foot.n, b.radius - foot.distance };
	}

	// The velocity change along n that a unit impulse along n on a sphere causes [1/kg]; 0: it cannot move so.
	double mobility(const BodyVelocity<Space3>& b, const Vector3& n)
	{
		const double along = b.w[0] * n.x * n.x + b.w[1] * n.y * n.y + b.w[2] * n.z * n.z;
		return ContactRow<Space3>::held(along, b.w[0] + b.w[1] + b.w[2]) ? 0 : along;
	}

	bool mayClose(const StepView<Space3>& step, const Pair& pair, double gap)
	{
		const double radius = step.smallerRadius(pair), beyond = gap - nearby * radius;
		if (beyond > mostWays * step.motion.ways(pair))
			return false;
		if (beyond <= pushed * radius)
			return true;
		const double before = step.relativeSpeed(pair, step.world.bodies[pair.a].v, step.world.bodies[pair.b].v);
		const double free = step.relativeSpeed(pair, step.bodies[pair.a].v, step.bodies[pair.b].v);
		return beyond <= soon * step.dt() * std::max(before, free) + pushed * radius;
	}

} // namespace

HiddenFeatures::Standing ContactFinder<Space3>::standing(const StepView<Space3>& step) const
{
	return { step.world, step.motion.places(), step.motion.shapes(), meetings };
}

bool ContactFinder<Space3>::isHidden(const StepView<Space3>& step, std::size_t pair) const
{
	return features.isHidden(standing(step), pair, step.dt());
}

// Whether a pair is closed, or would be closed within the step by its velocities before the step or by its free velocities.
bool ContactFinder<Space3>::closes(const StepView<Space3>& step, std::size_t index, const SpaceMeeting& met, double gap) const
{
	if (gap <= 0)
		return true;
	const Pair& pair = step.world.pairs[index];
	const SpaceTouch at = touchAt(met.n, -met.overlap, step.place(pair.b));
	const double before = step.approach(pair, at, step.world.bodies[pair.a].v, step.world.bodies[pair.b].v);
	const double free = step.approach(pair, at, step.bodies[pair.a].v, step.bodies[pair.b].v);
	return gap + step.turning(pair, at.n, gap) + step.dt() * std::min(before, free) <= 0;
}

void ContactFinder<Space3>::locate(const StepView<Space3>& step)
{
	const WorldOf<Space3>& world = step.world;
	constexpr std::size_t ahead = 16;
	forRanges(&step.threads, world.awake.size(), [&](std::size_t from, std::size_t to) {
		const SpacePlace* const places = step.motion.places().data();
		for (std::size_t k = from; k < to; k++) {
			if (k + ahead < to) {
				__builtin_prefetch(&places[world.pairs[world.awake[k + ahead]].a]);
				__builtin_prefetch(&places[world.pairs[world.awake[k + ahead]].b]);
			}
			const int32_t i = world.awake[k];
			const Pair& pair = world.pairs[i];
			meetings[i] = meet(places[pair.a], places[pair.b], step.shape(pair.a));
		}
	});
}

// Finds which of the pairs are contacts. Lists these from `from` on.
ContactFinder<Space3>::Found ContactFinder<Space3>::choose(const StepView<Space3>& step, std::size_t from, std::size_t to)
{
	const WorldOf<Space3>& world = step.world;
	const bool bounces = step.settings.restitution > 0;
	Found found;
	int32_t* next = found.first = pairOf.data() + from;
	for (; from < to; from++) {
		const int32_t i = world.awake[from];
		const Pair& pair = world.pairs[i];
		const SpaceMeeting* met = &meetings[i];
		const auto gapOf = [&] { return pair.reference > 0 && met->overlap <= 0 ? -met->overlap : pair.reference - met->overlap; };
		const auto touches = [&](double gap) {
			return (gap <= nearby * step.smallerRadius(pair) || mayClose(step, pair, gap)) && (!bounces || closes(step, i, *met, gap));
		};
		double gap = gapOf();
		bool isOne = touches(gap);
		if (isOne && isHidden(step, i)) {
			if ((isOne = features.meetsAhead(standing(step), i, step.dt(), ahead[i]))) {
				met = &ahead[i];
				gap = gapOf();
				isOne = touches(gap);
			}
			if (!isOne)
				gap = endless;
			found.ahead = found.ahead || isOne;
		}
		found.same = found.same && (contact[i] != 0) == isOne;
		contact[i] = isOne ? (met == &meetings[i] ? 1 : facetAhead) : 0;
		*next = i;
		next += isOne;
		(isOne ? found.deepest : found.narrowest) = isOne ? std::max(found.deepest, -gap) : std::min(found.narrowest, gap);
		found.apart = found.apart || (pair.reference > 0 && meetings[i].overlap <= 0);
	}
	found.contacts = static_cast<std::size_t>(next - found.first);
	return found;
}

// As in the plane: whether the centre of sphere b has entered boundary a, or gone right through it, in the first half of the step, by the places of
// two earlier moments.
bool ContactFinder<Space3>::isThrough(const StepView<Space3>& step, const Pair& pair, SpaceFoot& face) const
{
	const SpaceBody &a = step.world.bodies[pair.a], &b = step.world.bodies[pair.b];
	const Vector3 now = step.place(pair.b).at - step.place(pair.a).at;
	const auto through = [&](double ahead, SpaceFoot& by) {
		const SpaceShape was = turns(a) ? rotated(step.world.shapes[pair.a], ahead * spinOf(a)) : step.world.shapes[pair.a];
		return comesThrough(was, placeAhead(b, ahead).at - placeAhead(a, ahead).at, step.shape(pair.a), now, by);
	};
	SpaceFoot same;
	return through(0, face) && through(-0.5 * step.dt(), same) && face.n == same.n && mobility(step.bodies[pair.b], face.n) > 0;
}

// Moves such spheres back to the face, in the direction in which an impulse would push them. Repeats this as long as one enters another boundary.
bool ContactFinder<Space3>::stopAtFaces(const StepView<Space3>& step, BodyMotion<Space3>& motion)
{
	for (std::size_t before = motion.shifted();; before = motion.shifted()) {
		for (const int32_t i : step.world.awake) {
			const Pair& pair = step.world.pairs[i];
			const SpacePlace& b = step.place(pair.b);
			SpaceFoot face;
			if (!isBoundary(step.place(pair.a)) || b.radius - meetings[i].overlap > 0.5 * motion.ways(pair)
			    || !isThrough(step, pair, face))
				continue;
			const BodyVelocity<Space3>& v = step.bodies[pair.b];
			const double back = (b.radius - face.distance) / mobility(v, face.n);
			motion.shift(pair.b, { back * v.w[0] * face.n.x, back * v.w[1] * face.n.y, back * v.w[2] * face.n.z });
		}
		if (motion.shifted() == before || before > step.world.bodies.size())
			return motion.shifted() > 0;
		locate(step);
	}
}

bool ContactFinder<Space3>::find(
    WorldOf<Space3>& world, const StepView<Space3>& step, BodyMotion<Space3>& motion, const BodyMotion<Space3>::Start& start)
{
	assert(world.firstContact.empty() && &step.world == &world && &step.motion == &motion && world.carried.size() == world.pairs.size());
	bool known = knowsLast(world, start.sameMasses);
	meetings.resize(world.pairs.size());
	ahead.resize(world.pairs.size());
	makeRoom(world);
	features.list(world);
	locate(step);
	known = !stopAtFaces(step, motion) && known;
	const Found found = searchAll(world, step.threads, [&](std::size_t from, std::size_t to) { return choose(step, from, to); });
	if (found.ahead) // only now, since a pair is compared with others of its sphere
		for (const int32_t i : pairOf)
			if (contact[i] == facetAhead) {
				meetings[i] = ahead[i];
				contact[i] = 1;
			}
	keep(world, found, start.guides, [&](int32_t i) { return meetings[i].overlap; });
	if (world.compliant() && !found.same)
		passSprings(world);
	return known && found.same;
}

// Where a sphere goes from one boundary of a surface to the next, as over the inner edge of a mesh, its contact goes on: the springs of the pair that
// ends pass to the pair that begins. (Rigid contacts would gain a first guess only.)
void ContactFinder<Space3>::passSprings(WorldOf<Space3>& world) const
{
	constexpr double alike = 0.9; // cosine between the normals
	for (const int32_t i : pairOf) {
		if (world.carried[i].any() || !isBoundary(world.bodyOf(world.pairs[i].a)))
			continue;
		const auto ends = [&](std::size_t other) {
			SpaceCarried& carried = world.carried[other];
			if (contact[other] || !carried.any() || dot(carried.n, meetings[i].n) < alike)
				return false;
			world.carried[i] = std::exchange(carried, {});
			return true;
		};
		features.anyBeside(world, i, ends);
	}
}

bool ContactFinder<Space3>::fastEnough(const StepView<Space3>& step, std::size_t index) const
{
	const Pair& pair = step.world.pairs[index];
	const std::vector<SpaceMean>& means = step.motion.means();
	const double way = gap(step.world, index);
	if (way > quick * step.dt() * (means[pair.a].speed + means[pair.b].speed))
		return false;
	return way <= quick * step.dt() * step.relativeSpeed(pair, step.bodies[pair.a].v, step.bodies[pair.b].v) && !isHidden(step, index);
}

bool ContactFinder<Space3>::crosses(const StepView<Space3>& step, std::size_t index) const
{
	const Pair& pair = step.world.pairs[index];
	if (!fastEnough(step, index))
		return false;
	const SpaceTouch at = touch(step, index);
	const double way = gap(step.world, index);
	return way + step.turning(pair, at.n, way) + step.dt() * step.approach(pair, at, step.bodies[pair.a].v, step.bodies[pair.b].v) < 0;
}

bool ContactFinder<Space3>::addClosing(const StepView<Space3>& step)
{
	return add(
	    step, [&](int32_t i) { return crosses(step, i); }, [&](int32_t i) { return fastEnough(step, i); },
	    [&](int32_t i) { return gap(step.world, i); });
}

void ContactFinder<Space3>::locateAll(const WorldOf<Space3>& world, const BodyMotion<Space3>& motion)
{
	meetings.clear();
	for (const Pair& pair : world.pairs)
		meetings.push_back(meet(motion.places()[pair.a], motion.places()[pair.b], motion.shapes()[pair.a]));
}

} // namespace cd
