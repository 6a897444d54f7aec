#include "step/rolling_resistance.hpp"
#include "step/pair_lanes.hpp"

#include <algorithm>
#include <cassert>

namespace cd {

void RollingResistance<Plane>::guess(const StepView<Plane>& step, const ContactFinder<Plane>& finder, bool warm)
{
	any = fresh = step.world.rolls();
	guesses.assign(any ? finder.pairs().size() : 0, 0);
	warm = warm && any;
	for (std::size_t i = 0; warm && i < finder.foundFirst(); i++)
		guesses[i] = step.dt() * step.world.carried[finder.pairs()[i]].moment / step.smallerRadius(step.world.pairs[finder.pairs()[i]]);
}

void RollingResistance<Plane>::makeRows(const StepView<Plane>& step, const ContactFinder<Plane>& finder, const ContactSystem<Plane>& planar)
{
	const World& world = step.world;
	const double h = step.dt();
	guesses.resize(finder.pairs().size());
	system.contacts.resize(planar.contacts.size());
	forRanges(&step.threads, planar.contacts.size(), [&](std::size_t from, std::size_t to) {
		for (std::size_t i = from; i < to; i++) {
			ContactRow<RollingPlane>& c = system.contacts[i];
			static_cast<ContactRow<Plane>&>(c) = planar.contacts[i];
			const Rolling& of = world.rollings[finder.pairs()[i]];
			c.length = step.smallerRadius(world.pairs[finder.pairs()[i]]);
			c.eta = of.bound / c.length;
			if (world.compliant() && !(of.stiffness > 0))
				c.eta = 0;
			c.assembleBlock(planar.bodies[c.a], planar.bodies[c.b]);
			if (world.isBelt(c.a))
				c.ar *= world.surfaces[c.a][2]; // over 1 rad/s (motion.hpp)
			if (world.isBelt(c.b))
				c.br *= world.surfaces[c.b][2];
			if (!(c.wrr > 0 || c.ar != 0 || c.br != 0))
				c.eta = 0;
			const bool springs = world.compliant() && c.eta > 0;
			c.cr = springs ? c.length * c.length / (of.stiffness * h * h) : 0;
			c.rollBias = springs ? -c.cr * h * world.carried[finder.pairs()[i]].moment / c.length : 0;
			c.pr = guesses[i];
			if (fresh && step.settings.warmStart && c.cr > 0) // as movedOn() in springs.inl
				c.pr -= rolling<double>(c, motionOf<Plane>(step.velocityBefore(c.a)), motionOf<Plane>(step.velocityBefore(c.b)))
				    / c.cr;
			c.pr = c.eta > 0 ? cutGuess<double>({ c.pn, c.pr }, c.eta, insideCone) : 0;
		}
	});
}

SolverReport RollingResistance<Plane>::solve(const StepView<Plane>& step, const ContactFinder<Plane>& finder, ContactSystem<Plane>& planar,
    const SolverSettings& settings, const Stillness<Plane>& stillness, Effort& effort)
{
	assert(step.settings.solveRolling && step.world.rollings.size() == step.world.pairs.size());
	planar.contacts.make();
	makeRows(step, finder, planar);
	fresh = false;
	system.memory = planar.memory;
	system.contactSet = planar.contactSet;
	system.contacts.compliant = planar.contacts.compliant;
	system.contacts.pushing = planar.contacts.pushing;
	system.bodies.swap(planar.bodies);
	system.places.swap(planar.places);
	const SolverReport report = step.settings.reduce ? islands(system, step.settings.solveRolling, settings, effort, &stillness)
							 : solveWhole(system, step.settings.solveRolling, settings, effort);
	system.bodies.swap(planar.bodies);
	system.places.swap(planar.places);
	for (std::size_t i = 0; i < guesses.size(); i++) {
		setImpulse(planar.contacts[i], withoutMoment(impulseOf(system.contacts[i])));
		guesses[i] = system.contacts[i].pr;
	}
	return report;
}

} // namespace cd
