// Vectors of the plane, and of space.
#pragma once

#include <cmath>

namespace cd {

struct Vector {
	double x, y;
	double operator[](int k) const { return k == 0 ? x : y; }
};

inline Vector operator+(Vector a, Vector b) { return { a.x + b.x, a.y + b.y }; }
inline Vector operator-(Vector a, Vector b) { return { a.x - b.x, a.y - b.y }; }
inline Vector operator*(double s, Vector a) { return { s * a.x, s * a.y }; }
inline double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }
inline double cross(Vector a, Vector b) { return a.x * b.y - a.y * b.x; }
inline double length(Vector a) { return std::hypot(a.x, a.y); }

struct Vector3 {
	double x, y, z;
	double operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
	double& operator[](int k) { return k == 0 ? x : k == 1 ? y : z; }
};

inline Vector3 operator+(const Vector3& a, const Vector3& b) { return { a.x + b.x, a.y + b.y, a.z + b.z }; }
inline Vector3 operator-(const Vector3& a, const Vector3& b) { return { a.x - b.x, a.y - b.y, a.z - b.z }; }
inline Vector3 operator-(const Vector3& a) { return { -a.x, -a.y, -a.z }; }
inline Vector3 operator*(double s, const Vector3& a) { return { s * a.x, s * a.y, s * a.z }; }
inline bool operator==(const Vector3& a, const Vector3& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
inline double dot(const Vector3& a, const Vector3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector3 cross(const Vector3& a, const Vector3& b) { return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x }; }
inline double length(const Vector3& a) { return std::sqrt(dot(a, a)); }
inline Vector3 vectorOf(const double* a) { return { a[0], a[1], a[2] }; }

} // namespace cd
