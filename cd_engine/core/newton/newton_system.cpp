#include "newton/newton_system.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cd {
namespace {

	// Marks the contacts that are not open. Returns whether any of them was unmarked before.
	bool markClosed(const std::vector<ContactState>& states, std::vector<char>& marks)
	{
		bool found = false;
		for (std::size_t i = 0; i < states.size(); i++)
			if (states[i] != ContactState::open && !marks[i]) {
				marks[i] = 1;
				found = true;
			}
		return found;
	}

	// The rows of `system.contacts` that can be solved, ascending: all but those whose bodies cannot move along the normal.
	std::vector<int32_t> solvableRows(ContactSystem<Plane>& system)
	{
		system.contacts.make();
		std::vector<int32_t> rows;
		for (std::size_t i = 0; i < system.contacts.size(); i++)
			if (system.contacts[i].wnn > 0)
				rows.push_back(static_cast<int32_t>(i));
		return rows;
	}

	bool moves(const BodyVelocity<Plane>& b) { return b.w[0] > 0 || b.w[1] > 0 || b.w[2] > 0; }

} // namespace

NewtonSystem<ContactSystem<Plane>>::NewtonSystem(ContactSystem<Plane>& s)
    : system(s)
    , rows(solvableRows(s))
    , freeVelocity(3 * s.bodies.size())
    , arms(12 * rows.size())
    , z(3 * s.bodies.size())
{
	d.resize(2 * rows.size());
	planned.resize(rows.size());
	for (std::size_t i = 0; i < s.bodies.size(); i++)
		std::copy_n(s.bodies[i].v, 3, &freeVelocity[3 * i]);
	for (std::size_t i = 0; i < rows.size(); i++) {
		const ContactRow<Plane>& c = s.contacts[rows[i]];
		d[2 * i] = c.wnn;
		// If nothing can move along t, any positive number will do.
		d[2 * i + 1] = c.wtt > 0 ? c.wtt : c.wnn;
		const double n[6] = { -c.nx, -c.ny, -c.an, c.nx, c.ny, c.bn }, t[6] = { c.ny, -c.nx, -c.at, -c.ny, c.nx, c.bt }; // rows of H^T
		for (std::size_t k = 0; k < 6; k++) {
			const double root = std::sqrt(s.bodies[k < 3 ? c.a : c.b].w[k % 3]);
			arms[12 * i + k] = root * n[k];
			arms[12 * i + 6 + k] = root * t[k];
		}
	}
}

void NewtonSystem<ContactSystem<Plane>>::load(std::vector<double>& p) const
{
	p.resize(2 * size());
	for (std::size_t i = 0; i < size(); i++) {
		p[2 * i] = system.contacts[rows[i]].pn;
		p[2 * i + 1] = system.contacts[rows[i]].pt;
	}
}

void NewtonSystem<ContactSystem<Plane>>::store(const std::vector<double>& p)
{
	for (std::size_t i = 0; i < system.bodies.size(); i++)
		std::copy_n(&freeVelocity[3 * i], 3, system.bodies[i].v);
	for (std::size_t i = 0; i < size(); i++) {
		system.contacts[rows[i]].pn = p[2 * i];
		system.contacts[rows[i]].pt = p[2 * i + 1];
	}
	for (const ContactRow<Plane>& c : system.contacts)
		applyImpulse(c, system.bodies[c.a], system.bodies[c.b], impulseOf(c));
}

void NewtonSystem<ContactSystem<Plane>>::velocities(const std::vector<double>& p, std::vector<double>& u)
{
	store(p);
	u.resize(2 * size());
	for (std::size_t i = 0; i < size(); i++) {
		const ContactRow<Plane>& c = system.contacts[rows[i]];
		const auto [un, ut] = relativeVelocity(c, system.bodies[c.a], system.bodies[c.b]);
		u[2 * i] = un + c.bias;
		u[2 * i + 1] = ut;
	}
}

// Contacts that have been open so far need no place in the matrix. In a packing they can be half of all contacts.
void NewtonSystem<ContactSystem<Plane>>::plan(const std::vector<ContactState>& states)
{
	if (!markClosed(states, planned) && matrix.rows() == system.bodies.size())
		return;
	std::vector<std::pair<int32_t, int32_t>> pairs;
	for (std::size_t i = 0; i < size(); i++) {
		const ContactRow<Plane>& c = system.contacts[rows[i]];
		if (planned[i] && moves(system.bodies[c.a]) && moves(system.bodies[c.b]))
			pairs.emplace_back(c.a, c.b);
	}
	matrix.plan(system.bodies.size(), pairs);
}

// z is the change of M^(1/2) v from v(pk), and a_n, a_t are the rows of H^T M^(-1/2). Eliminating the impulses contact by contact leaves
//   (sigma + sum a_n a_n'/D_n + sum a_t a_t'/D_t +- sum mu a_t a_n'/D_n) z = the push of the contacts at z = 0.
// The first sum is over contacts that are not open, the second over sticking contacts, the third over sliding ones.
void NewtonSystem<ContactSystem<Plane>>::assemble(const Proximal& at)
{
	matrix.clear();
	std::fill(z.begin(), z.end(), 0);
	for (std::size_t i = 0; i < system.bodies.size(); i++) {
		BlockMatrix<3>::Block& own = matrix.at(static_cast<int32_t>(i), static_cast<int32_t>(i));
		own[0] = own[4] = own[8] = at.sigma;
	}
	for (std::size_t i = 0; i < size(); i++) {
		const ContactRow<Plane>& c = system.contacts[rows[i]];
		const int32_t body[2] = { c.a, c.b };
		const ContactState state = at.states[i];
		const bool open = state == ContactState::open, stick = state == ContactState::stick;
		const double slope = at.coupled ? side(state) * c.mu : 0, fixed = at.coupled ? 0 : side(state) * at.bounds[i];
		const double *n = &arms[12 * i], *t = n + 6, *pk = &at.pk[2 * i];
		const double closing = -at.u[2 * i] / d[2 * i], slipping = -at.u[2 * i + 1] / d[2 * i + 1];
		const double pushN = open ? -at.sigma * pk[0] : closing;
		const double pushT = open ? -at.sigma * pk[1] : stick ? slipping : at.sigma * (fixed + slope * pk[0] - pk[1]) + slope * closing;
		for (std::size_t k = 0; k < 6; k++)
			z[3 * static_cast<std::size_t>(body[k / 3]) + k % 3] += n[k] * pushN + t[k] * pushT;
		if (open)
			continue;
		double left[6], leftT[6]; // the contact adds left n' + leftT t' to the matrix
		for (std::size_t k = 0; k < 6; k++) {
			left[k] = (n[k] + slope * t[k]) / d[2 * i];
			leftT[k] = stick ? t[k] / d[2 * i + 1] : 0;
		}
		for (std::size_t row = 0; row < 2; row++)
			for (std::size_t column = 0; column < 2; column++) {
				if (!moves(system.bodies[body[row]]) || !moves(system.bodies[body[column]]))
					continue;
				BlockMatrix<3>::Block& block = matrix.at(body[row], body[column]);
				for (std::size_t k = 0; k < 3; k++)
					for (std::size_t l = 0; l < 3; l++)
						block[3 * k + l] += left[3 * row + k] * n[3 * column + l] + leftT[3 * row + k] * t[3 * column + l];
			}
	}
}

bool NewtonSystem<ContactSystem<Plane>>::solve(const Proximal& at, std::vector<double>& p)
{
	assert(at.sigma > 0 && at.pk.size() == 2 * size() && at.u.size() == 2 * size() && at.states.size() == size());
	plan(at.states);
	assemble(at);
	if (!matrix.factorize())
		return false;
	matrix.solve(z);
	p.assign(2 * size(), 0);
	for (std::size_t i = 0; i < size(); i++) {
		if (at.states[i] == ContactState::open)
			continue;
		const ContactRow<Plane>& c = system.contacts[rows[i]];
		double un = at.u[2 * i], ut = at.u[2 * i + 1];
		for (std::size_t k = 0; k < 6; k++) {
			const double change = z[3 * static_cast<std::size_t>(k < 3 ? c.a : c.b) + k % 3];
			un += arms[12 * i + k] * change;
			ut += arms[12 * i + 6 + k] * change;
		}
		double &pn = p[2 * i], &pt = p[2 * i + 1];
		pn = at.pk[2 * i] - un / (at.sigma * d[2 * i]);
		pt = at.states[i] == ContactState::stick ? at.pk[2 * i + 1] - ut / (at.sigma * d[2 * i + 1])
							 : side(at.states[i]) * (at.coupled ? c.mu * pn : at.bounds[i]);
	}
	return true;
}

NewtonSystem<DelassusSystem>::NewtonSystem(DelassusSystem& s)
    : system(s)
{
	planned.resize(size());
	d.resize(2 * size());
	root.resize(2 * size());
	for (std::size_t i = 0; i < size(); i++) {
		d[2 * i] = s.blocks[s.diagonal[i]].nn;
		d[2 * i + 1] = s.blocks[s.diagonal[i]].tt;
	}
	std::transform(d.begin(), d.end(), root.begin(), [](double x) { return std::sqrt(x); });
}

void NewtonSystem<DelassusSystem>::plan(const std::vector<ContactState>& states)
{
	if (!markClosed(states, planned) && matrix.rows() == size())
		return;
	std::vector<std::pair<int32_t, int32_t>> pairs;
	for (std::size_t i = 0; i < size(); i++)
		for (std::size_t k = system.start[i]; k < system.start[i + 1]; k++) {
			const auto j = static_cast<std::size_t>(system.column[k]);
			if (planned[i] && planned[j] && i != j)
				pairs.emplace_back(static_cast<int32_t>(i), system.column[k]);
		}
	matrix.plan(size(), pairs);
}

// The unknowns are the changes of p sqrt(D), and the equations are divided by sqrt(D): all rows and columns then have the same scale. Open contacts
// have no unknowns and go to the right-hand side.
void NewtonSystem<DelassusSystem>::assemble(const Proximal& at, std::vector<double>& p)
{
	matrix.clear();
	for (std::size_t i = 0; i < size(); i++) {
		const double rn = root[2 * i], rt = root[2 * i + 1], *pk = &at.pk[2 * i];
		const ContactState state = at.states[i];
		const bool open = state == ContactState::open, stick = state == ContactState::stick;
		const double slope = at.coupled ? side(state) * system.mu[i] : 0, fixed = at.coupled ? 0 : side(state) * at.bounds[i];
		BlockMatrix<2>::Block& own = matrix.at(static_cast<int32_t>(i), static_cast<int32_t>(i));
		double n = -at.u[2 * i], t = -at.u[2 * i + 1];
		for (std::size_t k = system.start[i]; k < system.start[i + 1] && !open; k++) {
			const auto j = static_cast<std::size_t>(system.column[k]);
			const Block& w = system.blocks[k];
			if (at.states[j] == ContactState::open) {
				n += w.nn * at.pk[2 * j] + w.nt * at.pk[2 * j + 1];
				t += w.tn * at.pk[2 * j] + w.tt * at.pk[2 * j + 1];
				continue;
			}
			BlockMatrix<2>::Block& block = matrix.at(static_cast<int32_t>(i), system.column[k]);
			block[0] = w.nn / (root[2 * j] * rn);
			block[1] = w.nt / (root[2 * j + 1] * rn);
			if (stick) {
				block[2] = w.tn / (root[2 * j] * rt);
				block[3] = w.tt / (root[2 * j + 1] * rt);
			}
		}
		own[0] = open ? 1 : own[0] + at.sigma;
		own[3] = stick ? own[3] + at.sigma : 1;
		if (!open && !stick)
			own[2] = -slope * rt / rn;
		p[2 * i] = open ? -pk[0] * rn : n / rn;
		p[2 * i + 1] = stick ? t / rt : ((open ? 0 : fixed + slope * pk[0]) - pk[1]) * rt;
	}
}

bool NewtonSystem<DelassusSystem>::solve(const Proximal& at, std::vector<double>& p)
{
	assert(at.sigma > 0 && at.pk.size() == 2 * size() && at.u.size() == 2 * size() && at.states.size() == size());
	plan(at.states);
	p.resize(2 * size());
	assemble(at, p);
	if (!matrix.factorize())
		return false;
	matrix.solve(p);
	for (std::size_t k = 0; k < p.size(); k++)
		p[k] = at.pk[k] + p[k] / root[k];
	// Sets what the states fix exactly, without round-off.
	for (std::size_t i = 0; i < size(); i++) {
		if (at.states[i] == ContactState::open)
			p[2 * i] = p[2 * i + 1] = 0;
		else if (at.states[i] != ContactState::stick)
			p[2 * i + 1] = side(at.states[i]) * (at.coupled ? system.mu[i] * p[2 * i] : at.bounds[i]);
	}
	return true;
}

} // namespace cd
