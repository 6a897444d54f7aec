#include "delassus_system.hpp"
#include "partition.hpp"

#include <algorithm>

namespace cd {
namespace {

	// How a contact's unit impulses along n and t act on one of its bodies: force x, force y, torque.
	struct Arms {
		double n[3], t[3];
	};

	Arms armsOf(const ContactRow& c, bool onB)
	{
		const double s = onB ? 1 : -1;
		return { { s * c.nx, s * c.ny, s * (onB ? c.bn : c.an) }, { -s * c.ny, s * c.nx, s * (onB ? c.bt : c.at) } };
	}

	// Multiplies the two arms first, so that W is symmetric to the last bit.
	double coupling(const double* a, const double* b, const double* w) { return a[0] * b[0] * w[0] + a[1] * b[1] * w[1] + a[2] * b[2] * w[2]; }

} // namespace

std::vector<int32_t> solvableRows(const ContactSystem& system)
{
	std::vector<int32_t> rows;
	for (std::size_t i = 0; i < system.contacts.size(); i++)
		if (system.contacts[i].wnn > 0)
			rows.push_back(static_cast<int32_t>(i));
	return rows;
}

DelassusSystem assembleDelassus(const ContactSystem& system)
{
	const std::vector<int32_t> rows = solvableRows(system);
	// The contacts of each body, ascending. An immobile body couples nothing.
	std::vector<std::vector<int32_t>> of(system.bodies.size());
	for (std::size_t i = 0; i < rows.size(); i++)
		for (const int32_t body : { system.contacts[rows[i]].a, system.contacts[rows[i]].b })
			if (freedoms(system.bodies[body]) > 0)
				of[body].push_back(static_cast<int32_t>(i));

	DelassusSystem d;
	d.start.push_back(0);
	std::vector<int32_t> neighbours;
	for (std::size_t i = 0; i < rows.size(); i++) {
		const ContactRow& c = system.contacts[rows[i]];
		neighbours.clear();
		for (const int32_t body : { c.a, c.b })
			neighbours.insert(neighbours.end(), of[body].begin(), of[body].end());
		std::sort(neighbours.begin(), neighbours.end());
		neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
		for (const int32_t j : neighbours) {
			const ContactRow& e = system.contacts[rows[j]];
			Block block { 0, 0, 0, 0 };
			for (const bool onB : { false, true })
				for (const bool onOtherB : { false, true }) {
					const int32_t body = onB ? c.b : c.a;
					if (body != (onOtherB ? e.b : e.a))
						continue;
					const double* w = system.bodies[body].w;
					const Arms x = armsOf(c, onB), y = armsOf(e, onOtherB);
					block.nn += coupling(x.n, y.n, w);
					block.nt += coupling(x.n, y.t, w);
					block.tn += coupling(x.t, y.n, w);
					block.tt += coupling(x.t, y.t, w);
				}
			if (static_cast<std::size_t>(j) == i)
				d.diagonal.push_back(d.blocks.size());
			d.column.push_back(j);
			d.blocks.push_back(block);
		}
		d.start.push_back(d.blocks.size());
		double un, ut;
		relativeVelocity(c, system.bodies[c.a], system.bodies[c.b], un, ut);
		d.q.push_back(un + c.bias);
		d.q.push_back(ut);
		d.mu.push_back(c.mu);
		d.p.push_back(c.pn);
		d.p.push_back(c.pt);
	}
	return d;
}

} // namespace cd
