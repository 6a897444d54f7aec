// A problem of spheres in space by its matrix, for methods that need one.
#pragma once

#include "problem/cone_system.hpp"
#include "problem/contact_row_in_space.hpp"
#include "scene/scene.hpp"

namespace cd {

class ConeOfSpheres {
    public:
	// The number of blocks that the matrix of a problem would have.
	static std::size_t blocksOf(const ContactSystem<Space3>&);
	// Of a system whose bodies have their free velocities; the impulses in its rows are the first guess. Contacts along whose normals nothing can
	// move are left out.
	explicit ConeOfSpheres(const ContactSystem<Space3>&);

	// Gives the impulses in `matrix` to the rows of the same system.
	void giveBack(ContactSystem<Space3>&) const;

	ConeSystem matrix;

    private:
	// What an impulse of 1 along the normal and two tangents does to a body: force, and moment about its centre.
	struct End {
		int32_t body;
		Vector3 force[3], moment[3];
	};
	void addRow(const ContactSystem<Space3>&, std::size_t contact, const std::vector<std::vector<int32_t>>& endsOf);

	std::vector<int32_t> rows; // of each contact of the matrix: its row in the system
	std::vector<std::array<Vector3, 3>> axes; // and its normal and tangents
	std::vector<End> ends; // two a contact: on a, on b
};

} // namespace cd
