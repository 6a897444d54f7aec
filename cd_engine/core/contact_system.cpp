#include "contact_system.hpp"

namespace cd {

void ContactSystem::assembleLocalBlocks()
{
	for (ContactRow& c : contacts) {
		const double* wa = bodies[c.a].w;
		const double* wb = bodies[c.b].w;
		// A blocked rotation makes its arms irrelevant; zeroing them keeps the contact on the diagonal kernel.
		if (wa[2] == 0) c.an = c.at = 0;
		if (wb[2] == 0) c.bn = c.bt = 0;
		const double wx = wa[0] + wb[0], wy = wa[1] + wb[1];
		c.wnn = c.nx * c.nx * wx + c.ny * c.ny * wy + c.an * c.an * wa[2] + c.bn * c.bn * wb[2];
		c.wtt = c.ny * c.ny * wx + c.nx * c.nx * wy + c.at * c.at * wa[2] + c.bt * c.bt * wb[2];
		c.wnt = c.nx * c.ny * (wy - wx) + c.an * c.at * wa[2] + c.bn * c.bt * wb[2];
	}
}

} // namespace cd
