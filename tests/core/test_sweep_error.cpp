// The error computed from packed contacts, against the independent code.
#include "error/residual.hpp"
#include "sweeps/sweep.hpp"
#include "systems.hpp"

#include <doctest/doctest.h>
#include <vector>

using namespace cd;
using tests::heap;

namespace {

// Two systems that do not touch, their contacts in turn.
ContactSystem<Plane> interleaved(const ContactSystem<Plane>& one, const ContactSystem<Plane>& other)
{
	ContactSystem<Plane> s;
	s.bodies = one.bodies;
	s.bodies.insert(s.bodies.end(), other.bodies.begin(), other.bodies.end());
	for (std::size_t i = 0; i < one.contacts.size(); i++) {
		s.contacts.push_back(one.contacts[i]);
		ContactRow<Plane> c = other.contacts[i];
		c.a += static_cast<int32_t>(one.bodies.size());
		c.b += static_cast<int32_t>(one.bodies.size());
		s.contacts.push_back(c);
	}
	return s;
}

// Two pairs of slides, free along x only, that lie on each other, so that nothing passes through their contact. In one pair the light slide is
// pressed on the floor's side, in the other the heavy one; the other slide has no other contact.
void addSlides(ContactSystem<Plane>& s, double heavy)
{
	for (const int pressed : { 0, 1 }) {
		const auto light = static_cast<int32_t>(s.bodies.size());
		s.bodies.resize(s.bodies.size() + 2);
		s.bodies[light].w[0] = 1;
		s.bodies[light + 1].w[0] = 1 / heavy;
		ContactRow<Plane> c;
		c.a = light;
		c.b = light + 1;
		c.ny = 1;
		s.contacts.push_back(c);
		c.a = 0;
		c.b = light + pressed;
		c.nx = 1;
		c.ny = 0;
		s.contacts.push_back(c);
		s.bodies[light + pressed].v[0] = -0.1;
		s.bodies[light + pressed].pushed = 0.1;
		s.bodies[light + pressed].twisted = 0.1;
	}
}

} // namespace

TEST_CASE("the error of packed contacts is the independent one, on every processor")
{
	const GroupKernel<Plane>& usual = groupKernel<Plane>();
	for (const int contacts : { 1, 9, 300, 5000 }) // twice the last is more than a block
		for (const bool general : { false, true })
			for (const bool islands : { false, true })
				for (const double heavy : { 1., 1e3 }) {
					ContactSystem<Plane> s = heap(5, contacts, 0.4, general);
					if (islands)
						s = interleaved(s, heap(6, contacts, 0.1, general));
					for (std::size_t i = 0; i < s.bodies.size(); i++) {
						s.bodies[i].pushed = 0.01;
						s.bodies[i].twisted = i % 3 == 0 ? 0.02 : 0;
						if (i % 5 == 4)
							for (double& w : s.bodies[i].w)
								w /= heavy;
					}
					if (islands)
						addSlides(s, heavy);
					s.assembleBlocks();
					const std::vector<double> free = tests::velocitiesOf(s);
					for (const GroupKernel<Plane>& kernel : groupKernels<Plane>()) {
						CAPTURE(kernel.name);
						CAPTURE(contacts);
						CAPTURE(general);
						CAPTURE(islands);
						CAPTURE(heavy);
						useGroupKernel(kernel);
						ContactSystem<Plane> swept = s;
						Sweep<Plane> sweep(swept, 0);
						for (int i = 0; i < 3; i++)
							sweep();
						const Residual packed = sweep.error();
						sweep.store();
						const Residual apart = residual(swept, free);
						// Sums in another order.
						const auto same = [](double x) { return doctest::Approx(x).epsilon(1e-11); };
						CHECK(packed.norm == same(apart.norm));
						CHECK(packed.energy == same(apart.energy));
						CHECK(packed.maximum == same(apart.maximum));
						CHECK(packed.difference == same(apart.difference));
						CHECK(packed.impulse == same(apart.impulse));
						CHECK(packed.bodies == same(apart.bodies));
						CHECK(packed.body == apart.body);
					}
				}
	useGroupKernel(usual);
}
