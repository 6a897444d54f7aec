#include "newton/cone_proximal.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>

namespace cd {
namespace {
	double knob(const char* n, double d)
	{
		const char* e = getenv(n);
		return e ? atof(e) : d;
	}
	const double accurate = knob("ACC", 1e-2), rfac = knob("RFAC", 1);
	const int most = (int)knob("MOSTN", 30), halvings = (int)knob("HALV", 8), memory = (int)knob("GLL", 5);
	const double floorMiss = 1e-14;
} // namespace

ConeProximal::ConeProximal(const ConeSystem& s, int steps, double operations)
    : system(s)
    , mostSteps(steps)
    , mostWork(operations)
    , root(s.contacts())
    , q(s.q)
    , change(3 * s.contacts())
    , planned(s.contacts())
{
	for (std::size_t i = 0; i < root.size(); i++) {
		root[i] = std::sqrt(s.own(i)[0]);
		for (double& x : q[i])
			x /= root[i];
	}
}

void ConeProximal::velocities(const std::vector<Triple>& p, std::vector<Triple>& to) const
{
	to.resize(p.size());
	for (std::size_t i = 0; i < p.size(); i++) {
		Triple sum = { 0, 0, 0 };
		for (std::size_t k = system.start[i]; k < system.start[i + 1]; k++) {
			const auto j = static_cast<std::size_t>(system.column[k]);
			const double scale = 1 / root[j];
			ConeSystem::addProduct(sum, system.blocks[k], { scale * p[j][0], scale * p[j][1], scale * p[j][2] });
		}
		for (std::size_t c = 0; c < 3; c++)
			to[i][c] = sum[c] / root[i] + q[i][c] + sigma * (p[i][c] - centre[i][c]);
	}
}

double ConeProximal::measure(const std::vector<Triple>& p, std::vector<Triple>& of, std::vector<Triple>& to) const
{
	velocities(p, of);
	to.resize(p.size());
	double sum = 0;
	for (std::size_t i = 0; i < p.size(); i++) {
		const Triple z = { p[i][0] - r * of[i][0], p[i][1] - r * of[i][1], p[i][2] - r * of[i][2] };
		to[i] = difference(p[i], cutToDisk(z, system.mu[i]));
		sum += square(to[i]);
	}
	return sum;
}

// Contacts that have been open so far need no place in the matrix.
bool ConeProximal::plan()
{
	bool found = false;
	for (std::size_t i = 0; i < x.size(); i++)
		if (!planned[i] && x[i][0] - r * u[i][0] > 0)
			planned[i] = found = true;
	if (!found && matrix.rows() == x.size())
		return false;
	std::vector<std::pair<int32_t, int32_t>> pairs;
	for (std::size_t i = 0; i < x.size(); i++)
		for (std::size_t k = system.start[i]; k < system.start[i + 1]; k++)
			if (const auto j = static_cast<std::size_t>(system.column[k]); planned[i] && planned[j] && i != j)
				pairs.emplace_back(static_cast<int32_t>(i), system.column[k]);
	matrix.plan(x.size(), pairs);
	return true;
}

void ConeProximal::assemble()
{
	matrix.clear();
	for (std::size_t i = 0; i < x.size(); i++) {
		const auto row = static_cast<int32_t>(i);
		const Triple z = { x[i][0] - r * u[i][0], x[i][1] - r * u[i][1], x[i][2] - r * u[i][2] };
		double* const to = &change[3 * i];
		if (!(z[0] > 0)) {
			matrix.at(row, row) = { 1, 0, 0, 0, 1, 0, 0, 0, 1 };
			for (std::size_t c = 0; c < 3; c++)
				to[c] = -x[i][c];
			continue;
		}
		// The tangential rows are T du_t + B dp; T = 1 where the contact sticks.
		const double mu = system.mu[i], length = tangential(z);
		const bool slides = length > mu * z[0];
		const double e[2] = { slides ? z[1] / length : 0, slides ? z[2] / length : 0 }, k = slides ? mu * z[0] / length : 1;
		const double T[2][2] = { { slides ? k * (1 - e[0] * e[0]) : 1, slides ? -k * e[0] * e[1] : 0 },
			{ slides ? -k * e[0] * e[1] : 0, slides ? k * (1 - e[1] * e[1]) : 1 } };
		to[0] = -u[i][0];
		for (std::size_t c = 0; c < 2; c++)
			to[1 + c] = slides ? (-miss[i][1 + c] + mu * e[c] * r * u[i][0]) / r : -u[i][1 + c];
		for (std::size_t m = system.start[i]; m < system.start[i + 1]; m++) {
			const auto j = static_cast<std::size_t>(system.column[m]);
			const double scale = 1 / (root[i] * root[j]);
			ConeBlock w = system.blocks[m];
			for (double& number : w)
				number *= scale;
			if (i == j)
				w[0] += sigma, w[4] += sigma, w[8] += sigma;
			const ConeBlock rows
			    = { w[0], w[1], w[2], T[0][0] * w[3] + T[0][1] * w[6], T[0][0] * w[4] + T[0][1] * w[7], T[0][0] * w[5] + T[0][1] * w[8],
				      T[1][0] * w[3] + T[1][1] * w[6], T[1][0] * w[4] + T[1][1] * w[7], T[1][0] * w[5] + T[1][1] * w[8] };
			if (x[j][0] - r * u[j][0] > 0) {
				ConeBlock& block = matrix.at(row, system.column[m]);
				for (std::size_t c = 0; c < 9; c++)
					block[c] += rows[c];
			} else // an open contact gives up its impulse
				for (std::size_t c = 0; c < 9; c++)
					to[c / 3] += rows[c] * x[j][c % 3];
		}
		if (slides) {
			ConeBlock& own = matrix.at(row, row);
			for (std::size_t c = 0; c < 2; c++) {
				own[3 + 3 * c] -= mu * e[c] / r;
				for (std::size_t d = 0; d < 2; d++)
					own[4 + 3 * c + d] += ((c == d ? 1 : 0) - T[c][d]) / r;
			}
		}
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

bool ConeProximal::solve(const std::vector<Triple>& pk, const std::vector<Triple>& first, double s)
{
	sigma = s;
	r = rfac / (1 + sigma);
	centre = pk;
	x = first;
	for (std::size_t i = 0; i < x.size(); i++)
		for (std::size_t c = 0; c < 3; c++) {
			centre[i][c] *= root[i];
			x[i][c] *= root[i];
		}
	double now = measure(x, u, miss), best = now, begin = now;
	std::vector<double> recent(1, now);
	bool done = false;
	double size = 0;
	for (const Triple& t : x)
		size += square(t);
	for (int k = 0; k < most && !exhausted() && !done; k++) {
		if (!step())
			break;
		double a = 1, next = 0;
		const double limit = *std::max_element(recent.begin(), recent.end());
		for (int h = 0;; h++) {
			xNew = x;
			for (std::size_t i = 0; i < 3 * x.size(); i++)
				xNew[i / 3][i % 3] += a * change[i];
			next = measure(xNew, uNew, missNew);
			if (next <= limit * (1 - 1e-4 * a) || h == halvings)
				break;
			a *= 0.5;
		}
		std::swap(x, xNew);
		std::swap(u, uNew);
		std::swap(miss, missNew);
		now = next;
		recent.push_back(now);
		if ((int)recent.size() > memory)
			recent.erase(recent.begin());
		best = std::min(best, now);
		done = now <= accurate * accurate * begin || now <= floorMiss * floorMiss * size;
		if (!std::isfinite(now))
			break;
	}
	result.resize(x.size());
	for (std::size_t i = 0; i < x.size(); i++) {
		result[i] = cutToDisk(x[i], system.mu[i]);
		for (double& number : result[i])
			number /= root[i];
	}
	return done;
}

} // namespace cd
