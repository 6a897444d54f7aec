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
	uint32_t placeOf(int32_t x, int32_t y) { return static_cast<uint32_t>(x) + static_cast<uint32_t>(y) * 0x9E3779B1u; }

	double median(std::vector<double>& values)
	{
		const auto middle = values.begin() + static_cast<long>(values.size() / 2);
		std::nth_element(values.begin(), middle, values.end());
		return *middle;
	}

	bool mayTouch(int32_t p, int32_t q, int32_t apart) { return (p & q) != 0 && !(p == q && (p & apart) != 0); }

} // namespace

void NearPairs::find(const World& world, const std::vector<double>& margins, std::vector<NearPair>& found)
{
	const std::size_t n = world.shapes.size();
	assert(margins.size() == n && world.masks.size() == n);
	boxes.resize(n);
	for (auto& values : { &sides, &xs, &ys })
		values->clear();
	std::size_t disks = 0;
	for (std::size_t i = 0; i < n; i++) {
		const Body& b = world.bodyOf(i);
		const Half half = halfSides(b, world.shapes[i]);
		const double x = half.x + margins[i], y = half.y + margins[i];
		boxes[i] = { { b.x - x, b.y - y }, { b.x + x, b.y + y } };
		if (const Shape& shape = world.shapes[i]; isBoundary(b) && shape.kind == ShapeKind::wall && shape.sense != 0)
			(shape.sense > 0 ? boxes[i].low : boxes[i].high)[shape.axis] = -shape.sense * endless; // solid on the whole of its other side
		if (world.masks[i] != 0 && !isBoundary(b) && disks++ % (1 + n / sample) == 0) {
			sides.push_back(2 * x);
			xs.push_back(b.x);
			ys.push_back(b.y);
		}
	}
	found.clear();
	large.clear();
	entries.clear();
	if (sides.empty())
		return;
	// Medians of some disks, so that neither a giant body nor one far away makes the cells useless.
	width = widthOfCells * median(sides);
	origin[0] = median(xs);
	origin[1] = median(ys);
	for (std::size_t i = 0; i < n; i++)
		if (world.masks[i] != 0)
			enter(static_cast<int32_t>(i));
	sortByPlace();
	compareInRows(world, margins, found);
	for (const int32_t i : large)
		for (int32_t j = 0; j < static_cast<int32_t>(n); j++)
			if ((!boxes[j].large || j > i) && boxes[i].meets(boxes[j]))
				compare(world, margins, i, j, found);
}

int32_t NearPairs::cellOf(double at, int axis) const { return static_cast<int32_t>(std::clamp(std::floor((at - origin[axis]) / width), -1e9, 1e9)); }

void NearPairs::enter(int32_t shape)
{
	Box& box = boxes[shape];
	if (!((box.high[0] - box.low[0] + width) * (box.high[1] - box.low[1] + width) <= mostCells * width * width)) {
		box.large = true;
		large.push_back(shape);
		return;
	}
	const int32_t first[2] = { cellOf(box.low[0], 0), cellOf(box.low[1], 1) }, last[2] = { cellOf(box.high[0], 0), cellOf(box.high[1], 1) };
	for (int32_t row = first[1]; row <= last[1]; row++)
		entries.push_back({ box, row, first[1], shape, placeOf(first[0], row), placeOf(last[0], row) });
}

// Counting sort by slot.
void NearPairs::sortByPlace()
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

void NearPairs::compareInRows(const World& world, const std::vector<double>& margins, std::vector<NearPair>& found) const
{
	const auto count = static_cast<uint32_t>(sorted.size());
	for (uint32_t k = 0; k < count; k++) {
		const Entry& p = sorted[k];
		const auto compareWith = [&](uint32_t from, uint32_t to) {
			for (uint32_t m = from; m < to; m++) {
				const Entry& q = sorted[m];
				if ((q.row == p.row) & (std::max(p.firstRow, q.firstRow) == p.row) & p.box.meets(q.box))
					compare(world, margins, p.shape, q.shape, found);
			}
		};
		const bool wraps = p.lastPlace < p.place;
		compareWith(k + 1, wraps ? count : ends[p.lastPlace]);
		if (wraps)
			compareWith(0, ends[p.lastPlace]);
	}
}

void NearPairs::compare(const World& world, const std::vector<double>& margins, int32_t a, int32_t b, std::vector<NearPair>& found) const
{
	constexpr double roundOff = 1e-12;
	const Body &p = world.bodyOf(a), &q = world.bodyOf(b);
	if (isBoundary(p) && isBoundary(q))
		return;
	if (!isBoundary(p) && !isBoundary(q)) {
		const double dx = p.x - q.x, dy = p.y - q.y, most = (p.radius + q.radius + margins[a] + margins[b]) * (1 + roundOff);
		if (dx * dx + dy * dy > most * most)
			return;
	}
	if (!mayTouch(world.masks[a], world.masks[b], world.apart))
		return;
	const bool turned = !isBoundary(p) && (isBoundary(q) || b < a);
	found.push_back(turned ? NearPair { 0, b, a } : NearPair { 0, a, b });
}

} // namespace cd
