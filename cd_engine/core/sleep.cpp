#include "sleep.hpp"

#include <cstring>
#include <limits>

namespace cd {

uint64_t bitsOf(double x)
{
	const double positive = x + 0.; // -0 is 0
	uint64_t bits;
	std::memcpy(&bits, &positive, sizeof bits);
	return bits;
}

namespace {

	// Of the nearest number of 23 binary digits: a scene keeps impulses p as forces p/h, and h (p/h) may be p but for the last digit.
	uint64_t leadingBitsOf(double x) { return (bitsOf(x) + (1u << 28)) >> 29; }

} // namespace

// Every number times an odd number of its own, which the processor does side by side; then MurmurHash3's finalizer (A. Appleby, public domain).
uint64_t fingerprint(const ContactRow& c, const double* freeA, const double* freeB)
{
	uint64_t hash = static_cast<uint64_t>(static_cast<uint32_t>(c.a)) << 32 | static_cast<uint32_t>(c.b);
	uint64_t odd = 0x9e3779b97f4a7c15;
	const auto mix = [&](uint64_t bits) {
		hash += (bits ^ bits >> 31) * odd;
		odd += 0x9e3779b97f4a7c16; // even, so that it stays odd
	};
	for (const double x : { c.nx, c.ny, c.an, c.at, c.bn, c.bt, c.bias, c.mu, c.wnn, c.wnt, c.wtt })
		mix(bitsOf(x));
	for (int k = 0; k < 3; k++) {
		mix(bitsOf(freeA[k]));
		mix(bitsOf(freeB[k]));
	}
	mix(leadingBitsOf(c.pn));
	mix(leadingBitsOf(c.pt));
	hash = (hash ^ hash >> 33) * 0xff51afd7ed558ccd;
	hash = (hash ^ hash >> 33) * 0xc4ceb9fe1a85ec53;
	return hash ^ hash >> 33;
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
