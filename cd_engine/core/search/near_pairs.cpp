#include "search/near_pairs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	constexpr double mostCells = 64; // a shape that covers more is not entered in the grid
	constexpr double widthOfCells = 1.5; // in bounding boxes of the median disk
	constexpr std::size_t sample = 256; // disks whose medians are taken, about
	constexpr std::size_t fewestPlaces = 256; // more than any shape covers

	// Cells that are neighbours along x get neighbouring slots; the rows are scattered (Knuth, vol. 3, section 6.4).
	uint32_t placeOf(int32_t x, const int32_t (&row)[1]) { return static_cast<uint32_t>(x) + static_cast<uint32_t>(row[0]) * 0x9E3779B1u; }
	uint32_t placeOf(int32_t x, const int32_t (&row)[2])
	{
		return static_cast<uint32_t>(x) + (static_cast<uint32_t>(row[0]) * 0x85EBCA6Bu ^ static_cast<uint32_t>(row[1]) * 0x9E3779B1u);
	}

	// Half the sides of the bounding box along each axis.
	double along(const Half& half, int axis) { return axis == 0 ? half.x : half.y; }
	double along(const Vector3& half, int axis) { return half[axis]; }

	double median(std::vector<double>& values)
	{
		const auto middle = values.begin() + static_cast<long>(values.size() / 2);
		std::nth_element(values.begin(), middle, values.end());
		return *middle;
	}

	// Whether the surfaces of a boundary and a disk are further apart than `most`. In the plane their boxes decide, which may be nearer.
	bool isFar(const Body&, const Shape&, const Body&, double) { return false; }
	bool isFar(const SpaceBody& a, const SpaceShape& shape, const SpaceBody& b, double most)
	{
		const SpaceFoot foot = footOnBoundary(shape, b.at - a.at);
		return foot.distance - b.radius > most;
	}

	bool mayTouch(int32_t p, int32_t q, int32_t apart) { return (p & q) != 0 && !(p == q && (p & apart) != 0); }

} // namespace

template <class Space> void NearPairsOf<Space>::find(const World& world, const std::vector<double>& margins, std::vector<NearPair>& found)
{
	const std::size_t n = world.shapes.size();
	assert(margins.size() == n && world.masks.size() == n);
	boxes.resize(n);
	sides.clear();
	for (std::vector<double>& of : coordinates)
		of.clear();
	std::size_t disks = 0;
	for (std::size_t i = 0; i < n; i++) {
		const BodyOf<Space>& b = world.bodyOf(i);
		const auto half = halfSides(b, world.shapes[i]);
		const auto centre = centreOf(b);
		boxes[i].large = false;
		for (int k = 0; k < axes; k++) {
			const double side = along(half, k) + margins[i];
			boxes[i].low[k] = centre[k] - side;
			boxes[i].high[k] = centre[k] + side;
		}
		if (const ShapeOf<Space>& shape = world.shapes[i]; isBoundary(b) && shape.kind == ShapeKind::wall && shape.sense != 0)
			(shape.sense > 0 ? boxes[i].low : boxes[i].high)[shape.axis] = -shape.sense * endless; // solid on the whole of its other side
		if (world.masks[i] != 0 && !isBoundary(b) && disks++ % (1 + n / sample) == 0) {
			sides.push_back(2 * (along(half, 0) + margins[i]));
			for (int k = 0; k < axes; k++)
				coordinates[k].push_back(centre[k]);
		}
	}
	found.clear();
	large.clear();
	entries.clear();
	if (sides.empty())
		return;
	// Medians of some disks, so that neither a giant body nor one far away makes the cells useless.
	width = widthOfCells * median(sides);
	for (int k = 0; k < axes; k++)
		origin[k] = median(coordinates[k]);
	// Two boundaries make no pair: they are entered last, so that in each slot nobody need look at them for another one.
	order.clear();
	std::size_t first = 0; // boundary in it
	for (const bool boundary : { false, true }) {
		first = order.size();
		for (std::size_t i = 0; i < n; i++)
			if (world.masks[i] != 0 && isBoundary(world.bodyOf(i)) == boundary)
				order.push_back(static_cast<int32_t>(i));
	}
	for (const int32_t i : order)
		enter(i);
	sortByPlace();
	compareInRows(world, margins, found);
	for (const int32_t i : large) {
		const std::size_t count = isBoundary(world.bodyOf(i)) ? first : order.size();
		for (std::size_t k = 0; k < count; k++)
			if (const int32_t j = order[k]; (!boxes[j].large || j > i) && boxes[i].meets(boxes[j]))
				compare(world, margins, i, j, found);
	}
}

template <class Space> int32_t NearPairsOf<Space>::cellOf(double at, int axis) const
{
	return static_cast<int32_t>(std::clamp(std::floor((at - origin[axis]) / width), -1e9, 1e9));
}

template <class Space> void NearPairsOf<Space>::enter(int32_t shape)
{
	Box& box = boxes[shape];
	double cells = 1, most = mostCells; // [m^2] or [m^3], both
	int32_t first[axes], last[axes];
	for (int k = 0; k < axes; k++) {
		cells *= box.high[k] - box.low[k] + width;
		most *= width;
	}
	if (!(cells <= most)) {
		box.large = true;
		large.push_back(shape);
		return;
	}
	for (int k = 0; k < axes; k++) {
		first[k] = cellOf(box.low[k], k);
		last[k] = cellOf(box.high[k], k);
	}
	Entry e { box, {}, {}, shape, 0, 0 };
	std::copy_n(first + 1, axes - 1, e.firstRow);
	std::copy_n(first + 1, axes - 1, e.row);
	while (e.row[axes - 2] <= last[axes - 1]) {
		e.place = placeOf(first[0], e.row);
		e.lastPlace = placeOf(last[0], e.row);
		entries.push_back(e);
		e.row[0]++;
		for (int k = 0; k < axes - 2 && e.row[k] > last[k + 1]; k++) {
			e.row[k] = first[k + 1];
			e.row[k + 1]++;
		}
	}
}

// Counting sort by slot.
template <class Space> void NearPairsOf<Space>::sortByPlace()
{
	std::size_t places = fewestPlaces;
	while (places < entries.size())
		places *= 2;
	const auto mask = static_cast<uint32_t>(places - 1);
	ends.assign(places, 0);
	for (Entry& e : entries) {
		e.place &= mask;
		e.lastPlace &= mask;
		ends[e.place]++;
	}
	uint32_t before = 0;
	for (uint32_t& end : ends) {
		const uint32_t count = end;
		end = before; // the begin of this slot, until its entries have been moved
		before += count;
	}
	sorted.resize(entries.size());
	for (const Entry& e : entries)
		sorted[ends[e.place]++] = e;
}

template <class Space>
void NearPairsOf<Space>::compareInRows(const World& world, const std::vector<double>& margins, std::vector<NearPair>& found) const
{
	const auto count = static_cast<uint32_t>(sorted.size()), slots = static_cast<uint32_t>(ends.size());
	const auto isBoundaryAt = [&](uint32_t k) { return isBoundary(world.bodyOf(sorted[k].shape)); };
	for (uint32_t k = 0; k < count; k++) {
		const Entry& p = sorted[k];
		const auto compareWith = [&](uint32_t m) {
			const Entry& q = sorted[m];
			if (sharesFirst(p, q) & p.box.meets(q.box))
				compare(world, margins, p.shape, q.shape, found);
		};
		if (isBoundaryAt(k)) {
			for (uint32_t slot = p.place; slot != p.lastPlace;) {
				slot = (slot + 1) % slots;
				for (uint32_t m = slot > 0 ? ends[slot - 1] : 0; m < ends[slot] && !isBoundaryAt(m); m++)
					compareWith(m);
			}
			continue;
		}
		const bool wraps = p.lastPlace < p.place;
		for (uint32_t m = k + 1; m < (wraps ? count : ends[p.lastPlace]); m++)
			compareWith(m);
		for (uint32_t m = 0; wraps && m < ends[p.lastPlace]; m++)
			compareWith(m);
	}
}

template <class Space>
void NearPairsOf<Space>::compare(const World& world, const std::vector<double>& margins, int32_t a, int32_t b, std::vector<NearPair>& found) const
{
	constexpr double roundOff = 1e-12;
	const BodyOf<Space>&p = world.bodyOf(a), &q = world.bodyOf(b);
	if (isBoundary(p) && isBoundary(q))
		return;
	if (!isBoundary(p) && !isBoundary(q)) {
		const double most = (p.radius + q.radius + margins[a] + margins[b]) * (1 + roundOff);
		if (const auto way = centreOf(p) - centreOf(q); dot(way, way) > most * most)
			return;
	}
	if (!mayTouch(world.masks[a], world.masks[b], world.apart))
		return;
	if (isBoundary(p) || isBoundary(q)) {
		const int32_t boundary = isBoundary(p) ? a : b, disk = isBoundary(p) ? b : a;
		if (isFar(world.bodyOf(boundary), world.shapes[boundary], world.bodyOf(disk),
			margins[a] + margins[b] + roundOff * world.bodyOf(disk).radius))
			return;
	}
	const bool turned = !isBoundary(p) && (isBoundary(q) || b < a);
	found.push_back(turned ? NearPair { 0, b, a } : NearPair { 0, a, b });
}

template class NearPairsOf<Plane>;
template class NearPairsOf<Space3>;

} // namespace cd
