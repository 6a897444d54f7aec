#include "newton/cone_proximal.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	// All of these were moved by factors of 3 to 10, one at a time, without a failure on Siconos's six problems.
	constexpr double accurate = 1e-2; // factor by which a solution reduces the miss: the centre is only an estimate, too
	constexpr double roundOff = 1e-14; // miss relative to the impulses below which nothing is gained
	constexpr int most = 12; // steps; more seldom help where these do not
	constexpr int halvings = 2; // of a step whose miss is above those of the last few; long searches end in tiny steps
	constexpr std::size_t remembered = 5; // misses that the next one is compared with

} // namespace

ConeProximal::ConeProximal(const ConeSystem& s, int steps, double operations)
    : scaled(s)
    , mostSteps(steps)
    , mostWork(operations)
    , root(s.contacts())
    , q(s.q)
    , u(s.contacts())
    , miss(s.contacts())
    , result(s.contacts())
    , loaded(s.contacts())
    , planned(s.contacts())
    , change(3 * s.contacts())
{
	assert(s.consistent());
	for (std::size_t i = 0; i < root.size(); i++)
		root[i] = std::sqrt(s.own(i)[0]);
	for (std::size_t i = 0; i < root.size(); i++) {
		for (double& velocity : q[i])
			velocity /= root[i];
		for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++)
			for (double& w : scaled.blocks[k])
				w /= root[i] * root[s.column[k]];
	}
}

void ConeProximal::regularize(const std::vector<Triple>& pk, double by)
{
	for (std::size_t i = 0; i < root.size(); i++)
		for (std::size_t c = 0; c < 3; c++) {
			scaled.blocks[scaled.diagonal[i]][4 * c] += by - sigma;
			scaled.q[i][c] = q[i][c] - by * root[i] * pk[i][c];
		}
	sigma = by;
	r = 1 / (1 + sigma);
}

// Sets all that follows from x. Returns |x - cut(z)|^2.
double ConeProximal::measure()
{
	double sum = 0;
	for (std::size_t i = 0; i < x.size(); i++) {
		u[i] = scaled.velocity(i, x);
		const Triple z = point(i);
		loaded[i] = z[0] > 0;
		miss[i] = difference(x[i], cutToDisk(z, scaled.mu[i]));
		sum += square(miss[i]);
	}
	return sum;
}

// Contacts that have been open so far need no place in the matrix.
void ConeProximal::plan()
{
	bool found = false;
	for (std::size_t i = 0; i < x.size(); i++)
		if (loaded[i] && !planned[i])
			planned[i] = found = true;
	if (!found && matrix.rows() == x.size())
		return;
	std::vector<std::pair<int32_t, int32_t>> pairs;
	for (std::size_t i = 0; i < x.size(); i++)
		for (std::size_t k = scaled.start[i]; k < scaled.start[i + 1]; k++)
			if (planned[i] && planned[scaled.column[k]] && k != scaled.diagonal[i])
				pairs.emplace_back(static_cast<int32_t>(i), scaled.column[k]);
	matrix.plan(x.size(), pairs);
}

void ConeProximal::assemble()
{
	matrix.clear();
	for (std::size_t i = 0; i < x.size(); i++) {
		if (loaded[i]) {
			addContact(i, point(i));
			continue;
		}
		matrix.at(static_cast<int32_t>(i), static_cast<int32_t>(i)) = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
		for (std::size_t c = 0; c < 3; c++)
			change[3 * i + c] = -x[i][c];
	}
}

// The rows of a contact that is not open: du_n = -u_n, and T du_t + (1 - T) dp_t/r - (mu/r) e (dp_n + r u_n) = -miss_t/r, where e = z_t/|z_t| if it
// slides. If it sticks, T = 1 and e = 0.
void ConeProximal::addContact(std::size_t i, const Triple& z)
{
	const double mu = scaled.mu[i], length = tangential(z);
	const bool slides = length > mu * z[0];
	std::array<double, 2> e = { 0, 0 };
	std::array<double, 4> T = { 1, 0, 0, 1 };
	if (slides) {
		const double share = mu * z[0] / length, largest = std::max(mu * z[0], tangential(x[i]));
		e = { z[1] / length, z[2] / length };
		for (std::size_t c = 0; c < 4; c++)
			T[c] = share * ((c % 3 == 0 ? 1 : 0) - (largest > 0 ? x[i][1 + c / 2] / largest * e[c % 2] : 0));
	}
	double* const to = &change[3 * i];
	to[0] = -u[i][0];
	for (std::size_t c = 0; c < 2; c++)
		to[1 + c] = slides ? mu * e[c] * u[i][0] - miss[i][1 + c] / r : -u[i][1 + c];
	for (std::size_t k = scaled.start[i]; k < scaled.start[i + 1]; k++) {
		const std::size_t j = scaled.column[k];
		const ConeBlock& w = scaled.blocks[k];
		ConeBlock rows = w;
		for (std::size_t c = 0; slides && c < 6; c++)
			rows[3 + c] = T[2 * (c / 3)] * w[3 + c % 3] + T[2 * (c / 3) + 1] * w[6 + c % 3];
		if (loaded[j]) {
			ConeBlock& block = matrix.at(static_cast<int32_t>(i), scaled.column[k]);
			for (std::size_t c = 0; c < 9; c++)
				block[c] += rows[c];
		} else // an open contact gives up its impulse
			for (std::size_t c = 0; c < 9; c++)
				to[c / 3] += rows[c] * x[j][c % 3];
	}
	if (!slides)
		return;
	ConeBlock& own = matrix.at(static_cast<int32_t>(i), static_cast<int32_t>(i));
	for (std::size_t c = 0; c < 2; c++) {
		own[3 + 3 * c] -= mu * e[c] / r;
		for (std::size_t d = 0; d < 2; d++)
			own[4 + 3 * c + d] += ((c == d ? 1 : 0) - T[2 * c + d]) / r;
	}
}

bool ConeProximal::step()
{
	plan();
	assemble();
	made++;
	const bool regular = matrix.factorize();
	work += matrix.operations() + 3000. * static_cast<double>(x.size());
	if (regular)
		matrix.solve(change);
	return regular;
}

bool ConeProximal::descend()
{
	double now = measure(), size = 0;
	for (const Triple& p : x)
		size += square(p);
	const double goal = std::max(accurate * accurate * now, roundOff * roundOff * size);
	std::array<double, remembered> last;
	last.fill(now);
	for (std::size_t k = 0; !(now <= goal); k++) {
		if (k == most || exhausted() || !std::isfinite(now) || !step())
			return false;
		const double limit = *std::max_element(last.begin(), last.end());
		start = x;
		double share = 1;
		for (int h = 0;; h++) {
			for (std::size_t c = 0; c < change.size(); c++)
				x[c / 3][c % 3] = start[c / 3][c % 3] + share * change[c];
			now = measure();
			if (now <= limit || h == halvings)
				break;
			share *= 0.5;
		}
		last[k % remembered] = now;
	}
	return true;
}

bool ConeProximal::solve(const std::vector<Triple>& pk, const std::vector<Triple>& first, double by)
{
	assert(by > 0 && pk.size() == root.size() && first.size() == root.size());
	regularize(pk, by);
	x = first;
	for (std::size_t i = 0; i < x.size(); i++)
		for (double& p : x[i])
			p *= root[i];
	const bool solved = descend();
	for (std::size_t i = 0; i < x.size(); i++) {
		result[i] = cutToDisk(x[i], scaled.mu[i]);
		for (double& p : result[i])
			p /= root[i];
	}
	return solved;
}

} // namespace cd
