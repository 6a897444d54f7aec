#include "step/rebounds.hpp"

#include "step/view_in_space.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <limits>

namespace cd {
namespace {

	// Shares of e that are tried one after the other. Islands that create energy mostly do so only near e = 1, and only a little.
	constexpr double shares[] = { 15. / 16, 7. / 8, 3. / 4, 1. / 2, 0 };

	constexpr double roundOff = 1e-13; // relative, of energies, which are sums

	template <class Space> bool moves(const BodyOf<Space>& body)
	{
		return std::any_of(body.inverseMass, body.inverseMass + Space::components, [](double w) { return w > 0; });
	}

	// The speed that the forces of the step give a body [m/s]; infinite if none moves it.
	template <class Space> double gained(const StepView<Space>& step, int32_t body)
	{
		const BodyOf<Space>& own = step.world.bodies[body];
		double square = 0;
		for (int k = 0; k < Space::components; k++) {
			const double speed = step.dt() * own.inverseMass[k] * own.force[k];
			square += speed * speed;
		}
		return moves<Space>(own) ? std::sqrt(square) : endless;
	}

} // namespace

template <class Space> bool Rebounds<Space>::any() const
{
	return std::any_of(
	    demands.begin(), demands.end(), [](const Demand& d) { return !std::isnan(d.rebound) && bias(d.plain, d.rebound) != bias(d.plain, 0); });
}

template <class Space> void Rebounds<Space>::restart(const StepView<Space>& step, std::size_t contacts)
{
	demands.resize(contacts);
	balances.clear();
	if (contacts == 0)
		return;
	loads.assign(step.world.bodies.size(), 0);
	for (std::size_t i = 0; i < step.world.pairs.size(); i++)
		if (step.world.carried[i].any()) {
			const Pair& of = step.world.pairs[i];
			loads[of.a] += moves<Space>(step.world.bodies[of.b]) ? 2 : 1;
			loads[of.b] += moves<Space>(step.world.bodies[of.a]) ? 2 : 1;
		}
}

template <class Space>
double Rebounds<Space>::demand(std::size_t contact, const StepView<Space>& step, int32_t pair, const Approach& now, const ContactRow<Space>& c)
{
	const double e = step.world.restitutions.empty() ? step.settings.restitution : step.world.restitutions[pair];
	const int32_t a = step.world.pairs[pair].a, b = step.world.pairs[pair].b;
	const double ofA = gained(step, a), ofB = gained(step, b), un = now.un;
	const bool packed = (ofA == endless || loads[a] > 1) && (ofB == endless || loads[b] > 1);
	const double slow = packed ? std::min(ofA, ofB) : 0;
	const bool hits = un < -slow && now.gap + now.turned + step.dt() * un <= 0, parts = un > slow && now.gap <= 0;
	const bool rebounds = e > 0 && (hits || parts);
	demands[contact] = { c.bias, rebounds ? e * un : std::numeric_limits<double>::quiet_NaN() };
	return rebounds ? bias(c.bias, e * un) : c.bias;
}

template <class Space> void Rebounds<Space>::findIslands(const ContactSystem& system)
{
	partition.update(system);
	balances.resize(system.bodies.size());
}

// Reduces the rebounds of the islands that have lost a share of theirs. Returns whether this changes any bias.
template <class Space> bool Rebounds<Space>::reduce(ContactSystem& system)
{
	bool changed = false;
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		ContactRow<Space>& c = system.contacts[i];
		const Balance& balance = balanceOf(i);
		if (balance.lowered == 0 || std::isnan(demands[i].rebound))
			continue;
		const double lowered = bias(demands[i].plain, shares[balance.lowered - 1] * demands[i].rebound);
		changed = changed || lowered != c.bias;
		c.bias = lowered;
	}
	return changed;
}

template <class Space> bool Rebounds<Space>::giveUp(ContactSystem& system, int32_t row)
{
	findIslands(system);
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		if (row < 0 || static_cast<int32_t>(i) == row)
			balanceOf(i).lowered = static_cast<int>(std::size(shares));
	return reduce(system);
}

template <class Space>
bool Rebounds<Space>::lower(ContactSystem& system, const std::vector<BodyOf<Space>>& before, double dt, double tolerance, double e, bool atOnce)
{
	assert(before.size() <= system.bodies.size() && dt > 0 && tolerance >= 0);
	constexpr int all = static_cast<int>(std::size(shares));
	findIslands(system);
	for (Balance& balance : balances)
		balance.sinceBefore = balance.sinceFree = balance.scale = balance.energy = 0;
	for (std::size_t i = 0; i < before.size(); i++) { // what comes after them moves as prescribed
		const BodyVelocity<Space>& body = system.bodies[i];
		Balance& balance = balances[partition.name[i]];
		for (int k = 0; k < Space::freedoms; k++) {
			const double free = before[i].v[k] + dt * before[i].inverseMass[k] * before[i].force[k], change = body.v[k] - free;
			if (!(body.w[k] > 0) || change == 0)
				continue;
			balance.sinceBefore += 0.5 * change * (body.v[k] + before[i].v[k]) / body.w[k];
			balance.sinceFree += 0.5 * change * (body.v[k] + free) / body.w[k];
			balance.scale += change * change / body.w[k];
			balance.energy += 0.5 * body.v[k] * body.v[k] / body.w[k];
		}
	}
	// Subtracts the work of boundaries that move.
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow<Space>& c = system.contacts[i];
		if (!(c.pn > 0))
			continue;
		BodyVelocity<Space> a = system.bodies[c.a], b = system.bodies[c.b];
		for (BodyVelocity<Space>* body : { &a, &b })
			for (int k = 0; k < Space::freedoms; k++)
				if (body->w[k] > 0)
					body->v[k] = 0;
		const double work = dot(impulseOf(c), relativeVelocity(c, a, b));
		Balance& balance = balanceOf(i);
		balance.sinceBefore += work;
		balance.sinceFree += work;
	}
	const bool first = tolerance > mostGain(e) && !atOnce;
	bool any = false;
	remains = false;
	for (Balance& balance : balances) {
		const double gain = std::min(balance.sinceBefore, balance.sinceFree);
		const double allowed = std::clamp(tolerance, roundOff, mostGain(e)) * balance.scale + roundOff * balance.energy;
		if (!(gain > allowed))
			continue;
		(balance.lowered < all ? any : remains) = true;
		if (!first)
			balance.lowered = atOnce ? all : std::min(balance.lowered + 1, all);
	}
	return any && (first || reduce(system));
}

template class Rebounds<Plane>;
template class Rebounds<Space3>;

} // namespace cd
