#include "sleep.hpp"

#include <cstring>
#include <limits>

namespace cd {

int fingerprint(const double gained[3])
{
	uint64_t hash = 0;
	for (int k = 0; k < 3; k++) {
		const double positive = gained[k] + 0.; // turns -0 into +0
		uint64_t bits;
		std::memcpy(&bits, &positive, sizeof bits);
		hash = (hash ^ bits) * 0x9e3779b97f4a7c15;
		hash ^= hash >> 32;
	}
	return static_cast<int>(hash & 0x7fffffff);
}

double motion(const BodyVelocity& b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		if (b.v[k] != 0)
			sum += b.w[k] > 0 ? b.v[k] * b.v[k] / b.w[k] : std::numeric_limits<double>::infinity();
	return sum;
}

} // namespace cd
