// The packed sweep over W: which rows may be solved at once, and that neither the packing nor the processor shows in the result.
#include "matrix/delassus_sweep.hpp"
#include "kernels/group_kernel.hpp"
#include "problem/law.hpp"
#include "solvers/solver.hpp"
#include "base/workspace.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <doctest/doctest.h>
#include <map>
#include <random>
#include <set>

using namespace cd;

namespace {

// From blocks by row and column; the diagonal ones must be there.
DelassusSystem systemOf(const std::vector<std::map<int32_t, Block>>& rows)
{
	DelassusSystem s;
	s.start.push_back(0);
	for (std::size_t i = 0; i < rows.size(); i++) {
		for (const auto& [column, block] : rows[i]) {
			if (static_cast<std::size_t>(column) == i)
				s.diagonal.push_back(s.blocks.size());
			s.column.push_back(column);
			s.blocks.push_back(block);
		}
		s.start.push_back(s.blocks.size());
	}
	s.q.assign(2 * rows.size(), 0);
	s.mu.assign(rows.size(), 0);
	s.p.assign(2 * rows.size(), 0);
	return s;
}

// Contacts coupled to some before them, each diagonal block outweighing its row, so that sweeps contract; two of them coupled to many, and some
// one way only.
DelassusSystem scattered(unsigned seed, int contacts, double mu)
{
	std::mt19937 random(seed);
	std::uniform_real_distribution<double> unit(-1, 1);
	std::vector<std::map<int32_t, Block>> rows(contacts);
	const auto couple = [&](int i, int j, bool bothWays) {
		const Block b { unit(random), unit(random), unit(random), unit(random) };
		rows[i][j] = b;
		if (bothWays)
			rows[j][i] = { b.nn, b.tn, b.nt, b.tt };
	};
	for (int i = 1; i < contacts; i++)
		for (int k = 0; k < i % 5; k++) {
			const int j = std::max(0, i - 1 - static_cast<int>(random() % 40));
			couple(i, j, k != 3);
		}
	for (int i = 2; i < contacts && contacts > 60; i += 3) {
		couple(1, i, true);
		if (i % 2 == 0)
			couple(contacts - 1 - i % 2, i / 2, true);
	}
	for (int i = 0; i < contacts; i++) {
		double size = 0.5;
		for (const auto& [column, b] : rows[i])
			if (column != i)
				size += std::abs(b.nn) + std::abs(b.nt) + std::abs(b.tn) + std::abs(b.tt);
		const double nt = 0.3 * size * unit(random);
		rows[i][i] = { size, nt, nt, 1.5 * size };
	}
	DelassusSystem s = systemOf(rows);
	for (int i = 0; i < contacts; i++) {
		s.q[2 * i] = unit(random) - 0.3;
		s.q[2 * i + 1] = unit(random);
		s.mu[i] = mu;
		s.p[2 * i] = std::max(0., unit(random));
	}
	return s;
}

// One plain sweep in the order of the groups, contact by contact.
void sweepOneByOne(DelassusSystem& s, const RowGrouping& grouping)
{
	for (const int32_t i : grouping.members) {
		if (i < 0)
			continue;
		double q[2] = { s.q[2 * i], s.q[2 * i + 1] };
		for (std::size_t k = s.start[i]; k < s.start[i + 1]; k++)
			if (k != s.diagonal[i]) {
				const Block& w = s.blocks[k];
				const double* p = &s.p[2 * s.column[k]];
				q[0] += w.nn * p[0] + w.nt * p[1];
				q[1] += w.tn * p[0] + w.tt * p[1];
			}
		const Block& w = s.blocks[s.diagonal[i]];
		const Components<double> p = solveLocal(w.nn, w.nt, w.tn, w.tt, s.mu[i], q[0], q[1]);
		s.p[2 * i] = p.n;
		s.p[2 * i + 1] = p.t;
	}
}

bool sameBits(const std::vector<double>& a, const std::vector<double>& b)
{
	return a.size() == b.size()
	    && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return std::memcmp(&x, &y, sizeof x) == 0; });
}

} // namespace

TEST_CASE("no row is lost, those of a group do not couple, nor do neighbouring groups before the last 64; very long rows are alone")
{
	const DelassusSystem s = scattered(1, 3000, 0.5);
	RowGrouping grouping;
	for (const bool again : { false, true }) { // with what the first left behind
		CAPTURE(again);
		grouping.group(s);
		std::multiset<int32_t> seen;
		std::vector<int32_t> before;
		std::size_t lanes = 0, longest = 0, blocks = 0;
		for (std::size_t g = 0; g < grouping.groups(); g++) {
			std::vector<int32_t> now;
			std::size_t most = 0;
			for (int lane = 0; lane < RowGroup::lanes; lane++) {
				const int32_t row = grouping.members[g * RowGroup::lanes + lane];
				if (row >= 0)
					now.push_back(row);
			}
			CHECK((g < grouping.firstSpread ? now.size() > 1 : now.size() == 1));
			seen.insert(now.begin(), now.end());
			for (const int32_t row : now) {
				const auto first = s.column.begin() + s.start[row], last = s.column.begin() + s.start[row + 1];
				const auto couples = [&](int32_t other) { return other != row && std::find(first, last, other) != last; };
				CHECK(std::none_of(now.begin(), now.end(), couples));
				CHECK((g + 64 > grouping.firstSpread || std::none_of(before.begin(), before.end(), couples)));
				CHECK((g >= grouping.firstSpread || last - first <= 17));
				most = std::max<std::size_t>(most, last - first);
				blocks += g < grouping.firstSpread ? last - first : 0;
			}
			before = now;
			if (g < grouping.firstSpread) {
				lanes += RowGroup::lanes;
				longest += RowGroup::lanes * most;
			}
		}
		CHECK(seen.size() == s.contacts());
		CHECK(std::set<int32_t>(seen.begin(), seen.end()).size() == s.contacts());
		// What makes it worth while: few lanes and few blocks are empty (measured: 1 and 7 in a hundred).
		CHECK(lanes < 1.03 * s.contacts());
		CHECK(longest < 1.15 * blocks);
	}
}

TEST_CASE("a sweep is what it is contact by contact in the same order, up to round-off")
{
	for (const int contacts : { 1, 8, 9, 100, 1000 })
		for (const double mu : { 0., 0.4 }) {
			CAPTURE(contacts);
			CAPTURE(mu);
			DelassusSystem packed = scattered(2, contacts, mu), oneByOne = packed;
			RowGrouping grouping;
			grouping.group(packed);
			DelassusSweep sweep(packed, 0);
			for (int k = 0; k < 3; k++) {
				sweep();
				sweep.store();
				sweepOneByOne(oneByOne, grouping);
				double difference = 0;
				for (std::size_t i = 0; i < packed.p.size(); i++)
					difference = std::max(difference, std::abs(packed.p[i] - oneByOne.p[i]));
				CHECK(difference < 1e-14); // impulses of order 0.1: some ten roundings, which contracting sweeps do not amplify
			}
		}
}

TEST_CASE("every case of the local problem, wedging and singular ones among them, is solved as alone")
{
	std::mt19937 random(3);
	std::uniform_real_distribution<double> unit(-1, 1);
	std::vector<std::map<int32_t, Block>> rows(4000);
	for (std::size_t i = 0; i < rows.size(); i++) {
		const double nn = 0.1 + std::abs(unit(random)), tt = i % 7 == 0 ? 1e-16 : 0.1 + std::abs(unit(random)), nt = 0.9 * unit(random);
		// Any; regular and without coupling; singular with motion along t, and without.
		const Block block = i % 4 == 0 ? Block { nn, nt, nt, tt } : i % 4 == 1 ? Block { nn, 0, 0, tt } : Block { 1, 0.5, 0.5, 0.25 };
		rows[i][static_cast<int32_t>(i)] = i % 4 == 3 ? Block { nn, 0, 0, 1e-15 * nn } : block;
	}
	DelassusSystem s = systemOf(rows);
	for (std::size_t i = 0; i < s.contacts(); i++) {
		s.q[2 * i] = i % 50 == 0 ? 0 : unit(random) - 0.5;
		s.q[2 * i + 1] = i % 30 == 0 ? 0 : unit(random);
		s.mu[i] = i % 5 == 0 ? 0 : 2 * std::abs(unit(random));
	}
	DelassusSweep sweep(s, 0);
	sweep();
	sweep.store();
	for (std::size_t i = 0; i < s.contacts(); i++) {
		const Block& w = s.blocks[i];
		const Components<double> own = solveLocal(w.nn, w.nt, w.tn, w.tt, s.mu[i], s.q[2 * i], s.q[2 * i + 1]);
		const double pn = own.n, pt = own.t;
		CAPTURE(i);
		// Ten roundings; a determinant that cancels magnifies them.
		const double size = std::abs(pn) + std::abs(pt);
		const double cancelled = (w.nn * w.tt + std::abs(w.nt * w.tn)) / std::max(1e-3 * w.nn * w.tt, std::abs(w.nn * w.tt - w.nt * w.tn));
		CHECK(std::abs(s.p[2 * i] - pn) <= 2e-15 * size * std::max(1., cancelled));
		CHECK(std::abs(s.p[2 * i + 1] - pt) <= 2e-15 * size * std::max(1., cancelled));
		CHECK(std::abs(s.p[2 * i + 1]) <= s.mu[i] * s.p[2 * i] * (1 + 1e-15 * cancelled));
		if (i % 4 == 3 && s.q[2 * i + 1] != 0) // nothing can move along t: friction opposes the sliding
			CHECK(s.p[2 * i + 1] == doctest::Approx(std::copysign(s.mu[i] * s.p[2 * i], -s.q[2 * i + 1])));
	}
}

TEST_CASE("every processor gives the same bits of the matrix form, and memory left by another problem does not show")
{
	const GroupKernel<Plane>& usual = groupKernel<Plane>();
	Workspace memory;
	for (const int contacts : { 0, 1, 7, 8, 9, 64, 1000 })
		for (const double mu : { 0., 0.5 })
			for (const unsigned seed : { 0u, 3u })
				for (const auto method : { "nsgs", "accelerated" })
					for (const int fixed : { 0, 5 }) {
						CAPTURE(contacts);
						CAPTURE(method);
						const DelassusSystem start = scattered(4, contacts, mu);
						SolverSettings settings;
						settings.seed = seed;
						settings.fixedIterations = fixed;
						settings.tolerance = 1e-12;
						settings.maxIterations = 60;
						DelassusSystem first = start;
						const SolverReport expected = findDelassusSolver(method)(first, settings);
						for (const GroupKernel<Plane>& kernel : groupKernels<Plane>()) {
							CAPTURE(kernel.name);
							useGroupKernel(kernel);
							DelassusSystem other = start;
							other.memory = &memory;
							const SolverReport report = findDelassusSolver(method)(other, settings);
							CHECK(sameBits(first.p, other.p));
							CHECK(report.iterations == expected.iterations);
							CHECK(std::memcmp(&report.residual, &expected.residual, sizeof(double)) == 0);
						}
						useGroupKernel(usual);
					}
}

// Two contacts that carry one load between them, alike to one part in 1e5: sweeps share it out by a drift of 1e5 sweeps. Four hundred others
// have their solution at once.
TEST_CASE("a few contacts that drift while nothing else moves are followed")
{
	std::vector<std::map<int32_t, Block>> rows(402);
	for (int32_t i = 0; i < 402; i++)
		rows[i][i] = { 1, 0, 0, 3 };
	rows[200][201] = rows[201][200] = { 1 - 1e-5, 0, 0, 0 };
	DelassusSystem plain = systemOf(rows);
	for (std::size_t i = 0; i < plain.contacts(); i++)
		plain.q[2 * i] = -1;
	DelassusSystem followed = plain;
	SolverSettings settings;
	settings.tolerance = 1e-9;
	settings.maxIterations = 2000;
	CHECK(nsgs(plain, settings).residual > 1e-7);
	const SolverReport report = accelerated(followed, settings);
	CHECK(report.status == Status::converged);
	CHECK(report.iterations < 400); // measured: 220; without following them 20000 sweeps with momentum are not enough
	// Each carries half. Of a difference d from it the error e sees only 1e-5 d, over a norm of 20.
	CHECK(std::abs(followed.p[400] - 0.5) < 5e-3);
}
