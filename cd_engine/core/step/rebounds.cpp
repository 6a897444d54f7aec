#include "step/rebounds.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace cd {
namespace {

	// Shares of e that are tried one after the other. Islands that create energy mostly do so only near e = 1, and only a little.
	constexpr double shares[] = { 15. / 16, 7. / 8, 3. / 4, 1. / 2, 0 };

	constexpr double roundOff = 1e-13; // relative, of energies, which are sums

} // namespace

bool Rebounds::any() const
{
	return std::any_of(
	    asked.begin(), asked.end(), [](const Asked& a) { return !std::isnan(a.rebound) && bias(a.plain, a.rebound) != bias(a.plain, 0); });
}

void Rebounds::findIslands(const ContactSystem& system)
{
	partition.update(system);
	accounts.resize(system.bodies.size());
}

// Reduces the rebounds of the islands that have lost a share of theirs. Returns whether this changes any bias.
bool Rebounds::askAgain(ContactSystem& system)
{
	bool changed = false;
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		ContactRow& c = system.contacts[i];
		const Account& account = accountOf(i);
		if (account.lowered == 0 || std::isnan(asked[i].rebound))
			continue;
		const double lowered = bias(asked[i].plain, shares[account.lowered - 1] * asked[i].rebound);
		changed = changed || lowered != c.bias;
		c.bias = lowered;
	}
	return changed;
}

bool Rebounds::giveUp(ContactSystem& system, int32_t row)
{
	findIslands(system);
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		if (row < 0 || static_cast<int32_t>(i) == row)
			accountOf(i).lowered = static_cast<int>(std::size(shares));
	return askAgain(system);
}

bool Rebounds::lower(ContactSystem& system, const std::vector<Body>& before, const std::vector<double>& free, double tolerance, bool atOnce)
{
	constexpr int all = static_cast<int>(std::size(shares));
	findIslands(system);
	for (Account& account : accounts)
		account.sinceBefore = account.sinceFree = account.scale = account.energy = 0;
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		const BodyVelocity& body = system.bodies[i];
		Account& account = accounts[partition.name[i]];
		for (int k = 0; k < 3; k++) {
			const double change = body.v[k] - free[3 * i + k];
			if (!(body.w[k] > 0) || change == 0)
				continue;
			account.sinceBefore += 0.5 * change * (body.v[k] + before[i].v[k]) / body.w[k];
			account.sinceFree += 0.5 * change * (body.v[k] + free[3 * i + k]) / body.w[k];
			account.scale += change * change / body.w[k];
			account.energy += 0.5 * body.v[k] * body.v[k] / body.w[k];
		}
	}
	// Subtracts the work of boundaries that move.
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow& c = system.contacts[i];
		if (!(c.pn > 0))
			continue;
		BodyVelocity a = system.bodies[c.a], b = system.bodies[c.b];
		for (BodyVelocity* body : { &a, &b })
			for (int k = 0; k < 3; k++)
				if (body->w[k] > 0)
					body->v[k] = 0;
		double un, ut;
		relativeVelocity(c, a, b, un, ut);
		Account& account = accountOf(i);
		account.sinceBefore += c.pn * un + c.pt * ut;
		account.sinceFree += c.pn * un + c.pt * ut;
	}
	bool any = false;
	remains = false;
	for (Account& account : accounts) {
		const double gain = std::min(account.sinceBefore, account.sinceFree);
		const double allowed = std::clamp(tolerance, roundOff, mostGain) * account.scale + roundOff * account.energy;
		if (!(gain > allowed))
			continue;
		(account.lowered < all ? any : remains) = true;
		account.lowered = atOnce ? all : std::min(account.lowered + 1, all);
	}
	return any && askAgain(system);
}

} // namespace cd
