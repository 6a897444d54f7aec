// Vectors of the plane.
#pragma once

#include <cmath>

namespace cd {

struct Vector {
	double x, y;
};

inline Vector operator+(Vector a, Vector b) { return { a.x + b.x, a.y + b.y }; }
inline Vector operator-(Vector a, Vector b) { return { a.x - b.x, a.y - b.y }; }
inline Vector operator*(double s, Vector a) { return { s * a.x, s * a.y }; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
inline double length(Vector a) { return std::hypot(a.x, a.y); }

} // namespace cd
