// Selects the pairs that are contacts in a step.
#include "kernels/kernels.hpp"
#include "step/load_pairs.hpp"
#include "step/step_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace cd {
namespace {

	using namespace contact_limits;

} // namespace

double smallestRadius(const World& world)
{
	double smallest = std::numeric_limits<double>::infinity();
	for (const Body& b : world.bodies)
		smallest = b.radius > 0 ? std::min(smallest, b.radius) : smallest;
	return smallest;
}

inline void TimeStep::free(const Body& b, double dt, BodyVelocity& s)
{
	for (int k = 0; k < 3; k++) {
		s.w[k] = b.inverseMass[k];
		s.v[k] = b.v[k] + dt * b.inverseMass[k] * b.force[k];
	}
	const double ax = b.inverseMass[0] * b.force[0], ay = b.inverseMass[1] * b.force[1];
	s.pushed = dt * std::sqrt(ax * ax + ay * ay);
	s.twisted = dt * b.inverseMass[2] * std::abs(b.force[2]);
}

void TimeStep::freeAgain(const World& world, double dt)
{
	forRanges(&threads, world.bodies.size(), [&](size_t from, size_t to) {
		for (size_t i = from; i < to; i++)
			free(world.bodies[i], dt, system.bodies[i]);
	});
}

// Sets the free velocities of the bodies, their places at the mid-configuration, and their ways. Finds whether a boundary turns, and
// whether the inverse masses are those of the last step.
TimeStep::Begun TimeStep::beginBodies(const World& world, double dt)
{
	const std::size_t count = world.bodies.size();
	const bool known = system.bodies.size() == count;
	system.memory = &memory;
	system.bodies.resize(count);
	system.places.resize(count);
	places.resize(count);
	ways.resize(count);
	const auto begin = [&](size_t from, size_t to) {
		Begun begun { false, known, false };
		for (size_t i = from; i < to; i++) {
			const Body& b = world.bodies[i];
			begun.sameMasses = begun.sameMasses && std::equal(b.inverseMass, b.inverseMass + 3, system.bodies[i].w);
			free(b, dt, system.bodies[i]);
			places[i] = placeAhead(b, 0.5 * dt);
			system.places[i] = { places[i].x, places[i].y };
			ways[i] = wayOf(b, world.shapes[i], system.bodies[i].v, dt);
			begun.turns = begun.turns || (b.radius == 0 && b.v[2] != 0);
			begun.guides = begun.guides || (b.radius > 0 && isGuided(b));
		}
		return begun;
	};
	return reduceRanges<Begun>(&threads, count, begin, [](const Begun& a, const Begun& b) {
		return Begun { a.turns || b.turns, a.sameMasses && b.sameMasses, a.guides || b.guides };
	});
}

// The face through which the centre of disk b has entered boundary a in the first half of the step, if it has. Two earlier positions must
// give the same face: at the end of the last step contact was not required, and half a step before it the disk may not have been, if its
// velocity is new. A disk that cannot move along the normal goes on as prescribed.
bool TimeStep::isThrough(const Pair& pair, const World& world, const Touch& touch, double dt, Foot& face) const
{
	const Place &a = places[pair.a], &b = places[pair.b];
	if (b.radius - touch.overlap > 0.5 * (ways[pair.a] + ways[pair.b]))
		return false;
	Foot same;
	const auto through = [&](double ahead, Foot& by) {
		return comesThrough(world.shapes[pair.a], placeAhead(world.bodies[pair.a], ahead), placeAhead(world.bodies[pair.b], ahead), a, b, by);
	};
	if (!through(0, face) || !through(-0.5 * dt, same) || face.nx != same.nx || face.ny != same.ny)
		return false;
	const double* const w = system.bodies[pair.b].w;
	return !ContactRow::held(w[0] * face.nx * face.nx + w[1] * face.ny * face.ny, w[0] + w[1]);
}

// Moves such disks back to the face, in the direction in which an impulse would push them. Repeats this as long as a disk enters another boundary.
// The number of rounds is bounded, because two faces that pass each other would send a disk to and fro for ever.
void TimeStep::stopAtFaces(const World& world, double dt)
{
	std::size_t stopped;
	do {
		stopped = shifts.size();
		for (const int32_t i : world.awake) {
			const Pair& pair = world.pairs[i];
			Place& b = places[pair.b];
			Foot face;
			if (places[pair.a].radius > 0 || !isThrough(pair, world, locate(pair, world), dt, face))
				continue;
			const double* const w = system.bodies[pair.b].w;
			const double along = w[0] * face.nx * face.nx + w[1] * face.ny * face.ny;
			const double back = (b.radius - face.distance) / along, x = back * w[0] * face.nx, y = back * w[1] * face.ny;
			shifts.push_back({ pair.b, x, y });
			b.x += x;
			b.y += y;
		}
	} while (shifts.size() > stopped && stopped <= world.bodies.size());
}

// Whether a pair is a contact. This depends only on its gap and its two bodies' velocities, so a fast body makes no contacts elsewhere.
inline bool TimeStep::mayClose(const Pair& pair, const World& world, double gap, double dt) const
{
	const double radius = smallerRadius(pair), beyond = gap - nearby * radius;
	if (beyond > mostWays * (ways[pair.a] + ways[pair.b]))
		return false;
	if (beyond <= pushed * radius)
		return true;
	const double before = relativeSpeed(pair, world, world.bodies[pair.a].v, world.bodies[pair.b].v);
	const double free = relativeSpeed(pair, world, system.bodies[pair.a].v, system.bodies[pair.b].v);
	return beyond <= soon * dt * std::max(before, free) + pushed * radius;
}

void TimeStep::lookBack(const World& world, double dt)
{
	places.clear();
	for (const Body& b : world.bodies)
		places.push_back(placeAhead(b, -0.5 * dt));
	overlaps.clear();
	for (const Pair& pair : world.pairs)
		overlaps.push_back(locate(pair, world).overlap);
}

Touch TimeStep::touchOf(const World& world, std::size_t index) const
{
	return touchAt(world.carried[index].nx, world.carried[index].ny, -overlaps[index], places[world.pairs[index].b]);
}

// Keeps the rows of the last step, so that they are not constructed again.
void TimeStep::resizeRows(std::size_t count, const StepSettings& settings)
{
	system.contacts.resize(count);
	special.resize(count);
	rowPair.resize(count);
	rebounds.resize(settings.restitution > 0 ? count : 0);
}

// Whether a pair is closed, or would be closed within the step by its velocities before the step or by its free velocities.
bool TimeStep::closes(const World& world, const Pair& pair, const Touch& touch, double gap, double dt) const
{
	if (gap <= 0)
		return true;
	const double ax = touch.cx - places[pair.a].x, ay = touch.cy - places[pair.a].y;
	const auto approach
	    = [&](const double* a, const double* b) { return touch.nx * (b[0] - a[0] + a[2] * ay) + touch.ny * (b[1] - a[1] - a[2] * ax); };
	const double before = approach(world.bodies[pair.a].v, world.bodies[pair.b].v);
	const double after = approach(system.bodies[pair.a].v, system.bodies[pair.b].v);
	return gap + turning(pair, world, touch, gap, dt, world.bodies[pair.a].v[2]) + dt * std::min(before, after) <= 0;
}

// Decides whether a pair is a contact, where the kernel cannot. Finds the overlap and the gap if `a` is a boundary.
bool TimeStep::judge(
    const Pair& pair, const World& world, const StepSettings& settings, double beyond, double& overlap, double& gap, bool& through) const
{
	if (places[pair.a].radius == 0) {
		const Touch touch = locate(pair, world);
		Foot face;
		through = through || isThrough(pair, world, touch, settings.dt, face);
		overlap = touch.overlap;
		gap = pair.reference > 0 && overlap <= 0 ? -overlap : pair.reference - overlap; // the reference ends where their surfaces are apart
	}
	const bool closing = (beyond <= 0 || mayClose(pair, world, gap, settings.dt))
	    && (settings.restitution == 0 || closes(world, pair, locate(pair, world), gap, settings.dt));
	if (!closing || !corners.hide(world, places, pair, settings.dt))
		return closing;
	gap = endless;
	return false;
}

// Finds the overlaps of the pairs of each part, and which of them are contacts. Lists these from the begin of the part on.
TimeStep::Seen TimeStep::look(const World& world, const StepSettings& settings, Seen* parts)
{
	const Cut cut(world.awake.size());
	overlaps.resize(world.pairs.size());
	if (solved.size() != world.pairs.size() || world.awake.size() != world.pairs.size())
		solved.assign(world.pairs.size(), 0);
	rowPair.resize(world.awake.size());
	corners.list(world);
	forEach(&threads, cut.parts, [&](std::size_t part) {
		double deepest = 0, narrowest = endless;
		bool through = false, apart = false, same = true;
		const bool bounces = settings.restitution > 0;
		// Copies of the addresses, because to the compiler a store to `solved` might change the vectors themselves.
		char* const contact = solved.data();
		double* const overlapOf = overlaps.data();
		int32_t* const first = rowPair.data() + cut.from(part);
		int32_t* row = first;
		for (size_t from = cut.from(part), to = cut.from(part + 1); from < to; from += batch) {
			const int32_t* const which = world.awake.data() + from;
			const std::size_t count = std::min(batch, to - from);
			PairLanes pairs[batch / PairLanes::lanes];
			const std::size_t groups = load<false>(world, count, pairs, [&](std::size_t k) { return which[k]; });
			groupKernel().overlaps(places.data(), pairs, groups, nearby);
			for (std::size_t k = 0; k < count; k++) {
				if (k % PairLanes::lanes == 0 && !bounces && k + PairLanes::lanes <= count
				    && which[k + PairLanes::lanes - 1] - which[k] == PairLanes::lanes - 1) {
					const PairLanes& p = pairs[k / PairLanes::lanes];
					bool all = true, ended = false;
					double deep = 0;
					for (std::size_t lane = 0; lane < PairLanes::lanes; lane++) {
						all &= p.beyond[lane] <= 0;
						ended |= (p.reference[lane] > 0) & (p.overlap[lane] <= 0);
						deep = std::max(deep, -p.gap[lane]);
					}
					if (all) { // as in most of a packing: eight contacts that follow one another
						static constexpr char yes[PairLanes::lanes] = { 1, 1, 1, 1, 1, 1, 1, 1 };
						const int32_t i = which[k];
						std::memcpy(overlapOf + i, p.overlap, sizeof p.overlap);
						same = same && std::memcmp(contact + i, yes, sizeof yes) == 0;
						std::memcpy(contact + i, yes, sizeof yes);
						for (std::size_t lane = 0; lane < PairLanes::lanes; lane++)
							row[lane] = i + static_cast<int32_t>(lane);
						row += PairLanes::lanes;
						deepest = std::max(deepest, deep);
						apart = apart || ended;
						k += PairLanes::lanes - 1;
						continue;
					}
				}
				const PairLanes& p = pairs[k / PairLanes::lanes];
				const std::size_t lane = k % PairLanes::lanes;
				const int32_t i = which[k];
				double overlap = p.overlap[lane], gap = p.gap[lane];
				bool is = p.beyond[lane] <= 0 && !bounces;
				if (!is) {
					is = judge(world.pairs[i], world, settings, p.beyond[lane], overlap, gap, through);
					narrowest = is ? narrowest : std::min(narrowest, gap);
				}
				overlapOf[i] = overlap;
				same = same && contact[i] == is;
				contact[i] = is;
				*row = i;
				row += is;
				deepest = is ? std::max(deepest, -gap) : deepest;
				apart = apart || (p.reference[lane] > 0 && overlap <= 0);
			}
		}
		parts[part] = { static_cast<std::size_t>(row - first), 0, through, same, apart, deepest, narrowest };
	});
	Seen all;
	for (std::size_t part = 0; part < cut.parts; part++) {
		parts[part].first = all.contacts;
		all.contacts += parts[part].contacts;
		all.through = all.through || parts[part].through;
		all.same = all.same && parts[part].same;
		all.apart = all.apart || parts[part].apart;
		all.deepest = std::max(all.deepest, parts[part].deepest);
		all.narrowest = std::min(all.narrowest, parts[part].narrowest);
	}
	return all;
}

void TimeStep::findContacts(World& world, const StepSettings& settings, const Begun& begun)
{
	// Whether the flags `solved` tell which pairs were contacts in the last step.
	bool known = begun.sameMasses && world.listing != 0 && world.listing == listing && !appended && solved.size() == world.pairs.size()
	    && world.awake.size() == world.pairs.size();
	Seen parts[Cut::most], all = look(world, settings, parts);
	if (all.through) {
		known = false; // the flags are then those of the first look
		stopAtFaces(world, settings.dt);
		all = look(world, settings, parts);
	}
	deepest = all.deepest;
	narrowest = all.narrowest;
	for (size_t k = 0; all.apart && k < world.awake.size(); k++)
		if (Pair& pair = world.pairs[world.awake[k]]; pair.reference > 0 && overlaps[world.awake[k]] <= 0) {
			pair.reference = 0;
			forgotten.push_back(world.awake[k]);
		}
	rebounds.clear();
	const Cut cut(world.awake.size());
	for (std::size_t part = 0; part < cut.parts && all.contacts < rowPair.size(); part++)
		std::copy_n(rowPair.begin() + static_cast<long>(cut.from(part)), parts[part].contacts,
		    rowPair.begin() + static_cast<long>(parts[part].first));
	resizeRows(all.contacts, settings);
	assembled = all.contacts;
	if (begun.guides) {
		deepest = 0;
		for (const int32_t i : rowPair)
			deepest = isGuided(world, world.pairs[i]) ? deepest : std::max(deepest, -gapOf(world, i));
	}
	const bool same = known && all.same;
	system.contactSet += !same;
	listing = world.listing;
	appended = false;
	source = &world;
	sourceSettings = &settings;
	// Rows that push need a proof that there is a solution (feasibility.hpp), which reads all of them.
	const bool pushes = begun.turns || settings.gapCorrection != 0 || settings.restitution != 0;
	if (same && !pushes && settings.warmStart && sleepers.none() && findSpecial(world, settings))
		return system.contacts.postpone(this);
	system.contacts.forgetSource();
	ContactRow* const first = system.contacts.data();
	forEach(&threads, cut.parts,
	    [&](std::size_t part) { fillRows(world, settings, first, parts[part].first, parts[part].first + parts[part].contacts); });
}

const ContactSystem& TimeStep::assemble(World& world, const StepSettings& settings)
{
	prepare(world, settings);
	system.contacts.make();
	return system;
}

void TimeStep::prepare(World& world, const StepSettings& settings)
{
	world.carried.resize(world.pairs.size());
	if (!std::exchange(impulsesKnown, true)) // those of the last step, which nobody has asked for
		impulses.clear();
	const Begun begun = beginBodies(world, settings.dt);
	freeVelocity.clear();
	if (settings.restitution > 0)
		for (const BodyVelocity& b : system.bodies)
			freeVelocity.insert(freeVelocity.end(), b.v, b.v + 3);
	shifts.clear();
	findContacts(world, settings, begun);
}

} // namespace cd
