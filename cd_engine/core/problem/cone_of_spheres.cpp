#include "problem/cone_of_spheres.hpp"
#include "problem/law_in_space.hpp"

#include <cassert>

namespace cd {
namespace {

	// Two unit vectors orthogonal to n and to each other (Duff et al. 2017, JCGT 6).
	std::array<Vector3, 3> axesOf(const Vector3& n)
	{
		const double sign = std::copysign(1., n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
		return { n, Vector3 { 1 + sign * n.x * n.x * a, sign * b, -sign * n.x }, Vector3 { b, sign + n.y * n.y * a, -n.y } };
	}

	double weighted(const Vector3& a, const double* w, const Vector3& b) { return a.x * w[0] * b.x + a.y * w[1] * b.y + a.z * w[2] * b.z; }

	void addCoupling(ConeBlock& block, const Vector3* force, const Vector3* moment, const double* w, const Vector3* byForce, const Vector3* byMoment)
	{
		for (int k = 0; k < 9; k++)
			block[k] += weighted(force[k / 3], w, byForce[k % 3]) + weighted(moment[k / 3], w + 3, byMoment[k % 3]);
	}

} // namespace

std::size_t ConeOfSpheres::blocksOf(const ContactSystem<Space3>& system)
{
	std::vector<std::size_t> met(system.bodies.size());
	for (const ContactRow<Space3>& c : system.contacts) {
		met[c.a] += isMovable(system.bodies[c.a]);
		met[c.b] += isMovable(system.bodies[c.b]);
	}
	std::size_t blocks = system.contacts.size();
	for (const std::size_t contacts : met)
		blocks += contacts * (contacts - 1) * (contacts > 0);
	return blocks;
}

ConeOfSpheres::ConeOfSpheres(const ContactSystem<Space3>& system)
{
	std::vector<std::vector<int32_t>> endsOf(system.bodies.size()); // of each body that can move
	for (std::size_t i = 0; i < system.contacts.size(); i++) {
		const ContactRow<Space3>& c = system.contacts[i];
		if (!(c.wnn > 0))
			continue;
		rows.push_back(static_cast<int32_t>(i));
		axes.push_back(axesOf({ c.nx, c.ny, c.nz }));
		for (const bool b : { false, true }) {
			End end { b ? c.b : c.a, {}, {} };
			for (int k = 0; k < 3; k++) {
				end.force[k] = b ? axes.back()[k] : -axes.back()[k];
				end.moment[k] = -(b ? c.bt : c.at) * cross(axes.back()[0], axes.back()[k]);
			}
			if (isMovable(system.bodies[end.body]))
				endsOf[end.body].push_back(static_cast<int32_t>(ends.size()));
			ends.push_back(end);
		}
	}
	matrix.memory = system.memory;
	matrix.start.push_back(0);
	for (std::size_t i = 0; i < rows.size(); i++)
		addRow(system, i, endsOf);
	assert(matrix.consistent());
}

void ConeOfSpheres::addRow(const ContactSystem<Space3>& system, std::size_t contact, const std::vector<std::vector<int32_t>>& endsOf)
{
	const ContactRow<Space3>& c = system.contacts[rows[contact]];
	std::vector<std::pair<int32_t, int32_t>> met { { static_cast<int32_t>(contact), -1 } }; // contacts, and by which of its ends
	for (const std::size_t own : { 2 * contact, 2 * contact + 1 })
		for (const int32_t end : endsOf[ends[own].body])
			met.emplace_back(end / 2, static_cast<int32_t>(own % 2));
	std::sort(met.begin(), met.end());
	for (std::size_t k = 0; k < met.size(); k++) {
		const auto [other, by] = met[k];
		if (k == 0 || met[k - 1].first != other) {
			if (other == static_cast<int32_t>(contact))
				matrix.diagonal.push_back(matrix.blocks.size());
			matrix.column.push_back(other);
			matrix.blocks.push_back({});
		}
		if (by < 0)
			continue;
		const End& end = ends[2 * contact + by];
		for (const std::size_t there : { 2 * other, 2 * other + 1 })
			if (ends[there].body == end.body)
				addCoupling(matrix.blocks.back(), end.force, end.moment, system.bodies[end.body].w, ends[there].force,
				    ends[there].moment);
	}
	matrix.start.push_back(matrix.blocks.size());
	ConeBlock& own = matrix.blocks[matrix.diagonal.back()];
	own[0] += c.cn;
	own[4] += c.ct;
	own[8] += c.ct;
	const SpatialComponents<double> u = relativeVelocity(c, system.bodies[c.a], system.bodies[c.b]), p = impulseOf(c);
	const auto seen = [&](double n, double x, double y, double z) {
		const Vector3 across { x, y, z };
		return Triple { n, dot(axes[contact][1], across), dot(axes[contact][2], across) };
	};
	matrix.q.push_back(seen(u.n + c.bias, u.x + c.slipX, u.y + c.slipY, u.z + c.slipZ));
	matrix.p.push_back(seen(p.n, p.x, p.y, p.z));
	matrix.mu.push_back(c.mu);
}

void ConeOfSpheres::giveBack(ContactSystem<Space3>& system) const
{
	for (std::size_t i = 0; i < rows.size(); i++) {
		const Triple& p = matrix.p[i];
		const Vector3 across = p[1] * axes[i][1] + p[2] * axes[i][2];
		setImpulse(system.contacts[rows[i]], { p[0], across.x, across.y, across.z });
	}
}

} // namespace cd
