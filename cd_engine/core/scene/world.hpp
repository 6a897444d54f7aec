// A scene: bodies, their shapes, and the pairs of shapes that may touch. A time step reads and moves it. Nothing here depends on YADE or Python.
#pragma once

#include "base/base.hpp"
#include "scene/pair.hpp"
#include "scene/shape.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace cd {

template <class Space> struct WorldOf {
	using Body = BodyOf<Space>;

	std::vector<Body> bodies;
	std::vector<ShapeOf<Space>> shapes; // stored separately from the bodies, because the shapes of disks are never read
	// Of each shape: two make a pair only if their masks share a bit, but not if both have one mask and it has a bit of `apart`. 0: the shape has
	// no contacts.
	std::vector<int32_t> masks;
	int32_t apart = 0;
	std::vector<Pair> pairs;
	bool springs = false; // whether contacts have a stiffness; decides how bodies move, also while no two are near each other
	std::vector<Stiffness> stiffnesses; // of the pairs, if so; else empty
	std::vector<Rolling> rollings; // of the pairs; empty: none resists rolling
	// Of each pair: its first contact, then the number of all. Empty where each pair has one, of its own number, as in the plane.
	std::vector<int32_t> firstContact;
	std::vector<typename Space::Carried> carried; // by contact
	// Of each body: the velocity of its surface, if it stays in place (a belt). Empty: no surface moves. The velocities of the body itself are 0
	// then.
	std::vector<std::array<double, Space::freedoms>> surfaces;
	std::vector<double> restitutions; // of the pairs; empty: StepSettings::restitution for all
	// Of each shape [m]: the list of pairs holds every two whose gap is at most the sum of their two values. Empty: all pairs are listed.
	std::vector<double> listed;
	long listing = 0; // number of the list of pairs; a new list gets a new number. 0: not numbered, so each step compares the lists
	// Of each body: whether it is a boundary that nothing moves. What has been found of it stays true until the bodies are read anew, so steps
	// pass over it: a scene may have a hundred thousand facets. Empty, like `reading` 0: not known, so each step looks at all bodies.
	std::vector<uint8_t> still;
	long reading = 0; // number of the reading of the bodies; a new reading gets a new number
	std::vector<int32_t> awake; // indices of the pairs that a step looks at, ascending; Sleepers::update fills it before every step

	// By body: what is still, for those who have seen all bodies since this reading. Null: they have to look at each.
	const uint8_t* stillSince(long seen) const { return reading != 0 && reading == seen ? still.data() : nullptr; }

	bool isBelt(std::size_t body) const
	{
		return !surfaces.empty() && std::any_of(surfaces[body].begin(), surfaces[body].end(), [](double v) { return v != 0; });
	}
	bool rolls() const { return !rollings.empty(); }
	bool compliant() const { return springs; }
	// How far ahead of a step's beginning its contacts are located [s]: at the middle, or with stiffnesses, at the beginning.
	double ahead(double dt) const { return compliant() ? 0 : 0.5 * dt; }

	// The body that a shape moves with. In the plane each body has one shape, of its own number.
	const Body& bodyOf(std::size_t shape) const { return bodies[shape]; }

	std::size_t contacts() const { return firstContact.empty() ? pairs.size() : static_cast<std::size_t>(firstContact.back()); }
	Range contactsOf(std::size_t pair) const
	{
		if (firstContact.empty())
			return { pair, pair + 1 };
		return { static_cast<std::size_t>(firstContact[pair]), static_cast<std::size_t>(firstContact[pair + 1]) };
	}
	// Whether any contact of a pair carries a force.
	bool carries(std::size_t pair) const
	{
		const Range of = contactsOf(pair);
		return std::any_of(&carried[of.from], &carried[of.from] + of.size(), [](const auto& c) { return c.any(); });
	}
};
using World = WorldOf<Plane>;

// Whether no force can keep the two bodies of a pair apart. Such pairs have contacts, but their overlap means nothing: fixed disks that make a fixed
// floor rough may be half sunk in it.
template <class Space> bool isGuided(const WorldOf<Space>& world, const Pair& pair)
{
	return isGuided(world.bodyOf(pair.a)) && isGuided(world.bodyOf(pair.b));
}

} // namespace cd
