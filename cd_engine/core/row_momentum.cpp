#include "row_momentum.hpp"

#include <algorithm>
#include <cmath>

namespace cd {
namespace {

	constexpr double largest = 0.995; // largest beta
	// Windows grow with the sweeps made. Slow convergence, by a power of the number of sweeps, then still shows from one window to the next;
	// oscillations show no decrease.
	int window(int made) { return std::max(20, made / 4); }

} // namespace

void RowMomentum::begin(std::size_t count)
{
	groups.assign(count, {});
	beta.assign(count, 0);
	sum = lastMean = 0;
	made = windowStart = 0;
	windowEnd = window(0);
}

void RowMomentum::add(std::size_t group, const GroupStep& step)
{
	Group& g = groups[group];
	if (step.against > 0)
		g.t = ++g.turns % 3 == 0 ? 1 : std::max(1., 0.5 * g.t);
	else
		g.t += 0.5;
	beta[group] = std::min(g.cap, (g.t - 1) / (g.t + 0.5));
}

void RowMomentum::watch(const std::vector<GroupStep>& steps)
{
	double total = 0;
	for (std::size_t i = 0; i < groups.size(); i++) {
		total += steps[i].change;
		groups[i].sum += std::sqrt(steps[i].change);
	}
	sum += std::sqrt(total);
	if (++made < windowEnd)
		return;
	judge(made - windowStart);
	windowStart = made;
	windowEnd = made + window(made);
}

void RowMomentum::judge(int sweeps)
{
	const double mean = sum / sweeps;
	const bool swings = lastMean > 0 && mean > lastMean;
	lastMean = mean;
	sum = 0;
	for (Group& g : groups) {
		const double own = g.sum / sweeps;
		g.cap = swings && own > g.lastMean ? std::max(0., 1 - 3 * (1 - g.cap)) : std::min(largest, 1 - 0.8 * (1 - g.cap));
		g.lastMean = own;
		g.sum = 0;
	}
}

} // namespace cd
