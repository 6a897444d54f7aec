#include "step/contact_finder.hpp"
#include "search/search.hpp"
#include "step/pair_lanes.hpp"

#include <cassert>
#include <cstring>

namespace cd {
namespace {

	using namespace contact_limits;

	// The velocity of disk b against the point of a that it touches, along the normal [m/s].
	double approach(const StepView<Plane>& step, const Pair& pair, const Touch& touch, const double* a, const double* b)
	{
		const Place& from = step.place(pair.a);
		return touch.nx * (b[0] - a[0] + a[2] * (touch.cy - from.y)) + touch.ny * (b[1] - a[1] - a[2] * (touch.cx - from.x));
	}

	// The velocity change along a face that a unit impulse on disk b across it causes [1/kg]; 0: the disk cannot move so.
	double mobility(const BodyVelocity<Plane>& b, const Foot& face)
	{
		const double along = b.w[0] * face.nx * face.nx + b.w[1] * face.ny * face.ny;
		return ContactRow<Plane>::held(along, b.w[0] + b.w[1]) ? 0 : along;
	}

	// Whether the centre of disk b has entered boundary a in the first half of the step, and through which face. Two earlier positions must give
	// the same face: at the end of the last step contact was not required, and half a step before it the disk may not have been, if its velocity
	// is new. A disk that cannot move along the normal goes on as prescribed.
	bool isThrough(const StepView<Plane>& step, const Pair& pair, const Touch& touch, Foot& face)
	{
		const Place &a = step.place(pair.a), &b = step.place(pair.b);
		if (b.radius - touch.overlap > 0.5 * step.motion.ways(pair))
			return false;
		Foot same;
		const auto through = [&](double ahead, Foot& by) {
			const Place boundary = placeAhead(step.world.bodies[pair.a], ahead), disk = placeAhead(step.world.bodies[pair.b], ahead);
			return comesThrough(step.world.shapes[pair.a], boundary, disk, a, b, by);
		};
		return through(0, face) && through(-0.5 * step.dt(), same) && face.nx == same.nx && face.ny == same.ny
		    && mobility(step.bodies[pair.b], face) > 0;
	}

	// Moves such disks back to the face, in the direction in which an impulse would push them. Repeats this as long as a disk enters another
	// boundary. The number of rounds is bounded, because two faces that pass each other would send a disk to and fro for ever.
	void stopAtFaces(const StepView<Plane>& step, BodyMotion<Plane>& motion)
	{
		std::size_t before;
		do {
			before = motion.shifted();
			for (const int32_t i : step.world.awake) {
				const Pair& pair = step.world.pairs[i];
				Foot face;
				if (!isBoundary(step.place(pair.a)) || !isThrough(step, pair, step.locate(pair), face))
					continue;
				const BodyVelocity<Plane>& b = step.bodies[pair.b];
				const double back = (step.place(pair.b).radius - face.distance) / mobility(b, face);
				motion.shift(pair.b, { back * b.w[0] * face.nx, back * b.w[1] * face.ny });
			}
		} while (motion.shifted() > before && before <= step.world.bodies.size());
	}

	bool mayClose(const StepView<Plane>& step, const Pair& pair, double gap)
	{
		const double radius = step.smallerRadius(pair), beyond = gap - nearby * radius;
		if (beyond > mostWays * step.motion.ways(pair))
			return false;
		if (beyond <= pushed * radius)
			return true;
		const double before = step.relativeSpeed(pair, step.world.bodies[pair.a].v, step.world.bodies[pair.b].v);
		const double free = step.relativeSpeed(pair, step.velocity(pair.a), step.velocity(pair.b));
		return beyond <= soon * step.dt() * std::max(before, free) + pushed * radius;
	}

	// Whether a pair is closed, or would be closed within the step by its velocities before the step or by its free velocities.
	bool closes(const StepView<Plane>& step, const Pair& pair, double gap)
	{
		if (gap <= 0)
			return true;
		const Touch touch = step.locate(pair);
		const Body &a = step.world.bodies[pair.a], &b = step.world.bodies[pair.b];
		const double before = approach(step, pair, touch, a.v, b.v);
		const double free = approach(step, pair, touch, step.velocity(pair.a), step.velocity(pair.b));
		return gap + step.turning(pair, touch, gap, a.v[2]) + step.dt() * std::min(before, free) <= 0;
	}

} // namespace

// Decides whether a pair is a contact, where the kernel cannot. Finds the overlap and the gap if `a` is a boundary.
ContactFinder<Plane>::Examined ContactFinder<Plane>::examine(
    const StepView<Plane>& step, const Pair& pair, double beyond, double overlap, double gap) const
{
	Examined found { overlap, gap, false, false };
	if (isBoundary(step.place(pair.a))) {
		const Touch touch = step.locate(pair);
		Foot face;
		found.through = isThrough(step, pair, touch, face);
		found.overlap = touch.overlap;
		found.gap = pair.reference > 0 && touch.overlap <= 0 ? -touch.overlap : pair.reference - touch.overlap;
	}
	found.contact = (beyond <= 0 || mayClose(step, pair, found.gap)) && (step.settings.restitution == 0 || closes(step, pair, found.gap));
	if (found.contact && corners.isHidden(step.world, step.motion.places(), pair, step.dt())) {
		found.gap = endless;
		found.contact = false;
	}
	return found;
}

// Finds the overlaps of pairs and which of them are contacts. Lists these from `from` on.
ContactFinder<Plane>::Found ContactFinder<Plane>::searchRange(const StepView<Plane>& step, std::size_t from, std::size_t to)
{
	constexpr int lanes = PairLanes::lanes;
	const World& world = step.world;
	const bool bounces = step.settings.restitution > 0;
	// Copies of the addresses, because to the compiler a store to `contact` might change the vectors themselves.
	char* const isContact = contact.data();
	double* const overlapOf = overlaps.data();
	int32_t* next = pairOf.data() + from;
	Found found; // a copy is returned, so that it can stay in registers
	found.first = next;
	for (; from < to; from += batch) {
		const int32_t* const which = world.awake.data() + from;
		const std::size_t count = std::min(batch, to - from);
		PairLanes pairs[groupsInBatch];
		const std::size_t groups = load<false>(step, count, pairs, [&](std::size_t k) { return which[k]; });
		groupKernel<Plane>().overlaps(step.motion.places().data(), pairs, groups, nearby);
		for (std::size_t k = 0; k < count; k++) {
			const PairLanes& p = pairs[k / lanes];
			const std::size_t lane = k % lanes;
			const int32_t i = which[k];
			if (lane == 0 && !bounces && k + lanes <= count && which[k + lanes - 1] - i == lanes - 1) {
				bool all = true;
				for (int l = 0; l < lanes; l++)
					all &= p.beyond[l] <= 0;
				if (all) { // as in most of a packing: eight contacts that follow one another
					static constexpr char yes[lanes] = { 1, 1, 1, 1, 1, 1, 1, 1 };
					std::memcpy(overlapOf + i, p.overlap, sizeof p.overlap);
					found.same = found.same && std::memcmp(isContact + i, yes, sizeof yes) == 0;
					std::memcpy(isContact + i, yes, sizeof yes);
					for (int l = 0; l < lanes; l++) {
						next[l] = i + l;
						found.apart |= (p.reference[l] > 0) & (p.overlap[l] <= 0);
						found.deepest = std::max(found.deepest, -p.gap[l]);
					}
					next += lanes;
					k += lanes - 1;
					continue;
				}
			}
			Examined pair { p.overlap[lane], p.gap[lane], p.beyond[lane] <= 0 && !bounces, false };
			if (!pair.contact) {
				pair = examine(step, world.pairs[i], p.beyond[lane], pair.overlap, pair.gap);
				found.through = found.through || pair.through;
				found.narrowest = pair.contact ? found.narrowest : std::min(found.narrowest, pair.gap);
			}
			overlapOf[i] = pair.overlap;
			found.same = found.same && isContact[i] == pair.contact;
			isContact[i] = pair.contact;
			*next = i;
			next += pair.contact;
			found.deepest = pair.contact ? std::max(found.deepest, -pair.gap) : found.deepest;
			found.apart = found.apart || (p.reference[lane] > 0 && pair.overlap <= 0);
		}
	}
	found.contacts = static_cast<std::size_t>(next - found.first);
	return Found(found);
}

// The same for all pairs.
ContactFinder<Plane>::Found ContactFinder<Plane>::search(const StepView<Plane>& step)
{
	const World& world = step.world;
	overlaps.resize(world.pairs.size());
	makeRoom(world);
	corners.list(world);
	return searchAll(world, step.threads, [&](std::size_t from, std::size_t to) { return searchRange(step, from, to); });
}

bool ContactFinder<Plane>::find(World& world, const StepView<Plane>& step, BodyMotion<Plane>& motion, const BodyMotion<Plane>::Start& start)
{
	assert(world.firstContact.empty()); // so contacts have the numbers of their pairs
	assert(&step.world == &world && &step.motion == &motion && world.carried.size() == world.pairs.size());
	bool known = knowsLast(world, start.sameMasses);
	Found found = search(step);
	if (found.through) {
		known = false; // the flags are then those of the first search
		stopAtFaces(step, motion);
		found = search(step);
	}
	keep(world, found, start.guides, [&](int32_t i) { return overlaps[i]; });
	return known && found.same;
}

// Whether the bodies of a pair are fast enough, after the solution, to close its gap within the step, and no face is before it.
bool ContactFinder<Plane>::fastEnough(const StepView<Plane>& step, std::size_t index) const
{
	const Pair& pair = step.world.pairs[index];
	const std::vector<Mean>& means = step.motion.means();
	const double way = gap(step.world, index);
	if (way > quick * step.dt() * (means[pair.a].speed + means[pair.b].speed)) // true for most pairs
		return false;
	return way <= quick * step.dt() * step.relativeSpeed(pair, step.velocity(pair.a), step.velocity(pair.b))
	    && !corners.isHidden(step.world, step.motion.places(), pair, step.dt());
}

// Whether the solution lets a pair that was left out cross its gap within the step.
bool ContactFinder<Plane>::crosses(const StepView<Plane>& step, std::size_t index) const
{
	const Pair& pair = step.world.pairs[index];
	if (!fastEnough(step, index))
		return false;
	const Touch touch = step.locate(pair);
	const double *va = step.velocity(pair.a), *vb = step.velocity(pair.b), way = gap(step.world, index);
	return way + step.turning(pair, touch, way, va[2]) + step.dt() * approach(step, pair, touch, va, vb) < 0;
}

bool ContactFinder<Plane>::addClosing(const StepView<Plane>& step)
{
	return add(
	    step, [&](int32_t i) { return crosses(step, i); }, [&](int32_t i) { return fastEnough(step, i); },
	    [&](int32_t i) { return gap(step.world, i); });
}

void ContactFinder<Plane>::locateAll(const World& world, const BodyMotion<Plane>& motion)
{
	const std::vector<Place>& places = motion.places();
	overlaps.clear();
	for (const Pair& pair : world.pairs)
		overlaps.push_back(locateContact(places[pair.a], places[pair.b], world.shapes[pair.a]).overlap);
}

} // namespace cd
