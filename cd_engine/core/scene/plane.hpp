// What counts in the plane. A description of space would have 6 freedoms and 3 components.
#pragma once

namespace cd {

struct Plane {
	static constexpr int freedoms = 3; // of a body: x, y, and the rotation about z
	static constexpr int components = 2; // of a position or a force
};

} // namespace cd
