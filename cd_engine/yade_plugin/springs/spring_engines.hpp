// What the engines for springs share: they read what InteractionLoop has found, before NewtonIntegrator moves the bodies.
#pragma once

#include "../kind.hpp"
#include "../layout.hpp"
#include "../registered_engine.hpp"
#include "../waiting.hpp"

namespace cd_engine {

// Base of such an engine; Derived has a name and a step().
template <class Derived> class SpringEngine : public RegisteredEngine<Derived> {
    public:
	void action() override
	{
		try {
			checkPlace();
			static_cast<Derived*>(this)->step();
		} catch (const std::exception& error) {
			exchangeError(error.what());
			throw;
		}
	}

    protected:
	[[noreturn]] static void refuse(const std::string& what, const std::string& remedy)
	{
		throw SceneError(std::string(Derived::name) + ": " + what + ". " + remedy);
	}

	static std::string pairName(int id1, int id2) { return text("the contact of bodies #", id1, " and #", id2); }

	// Calls visit(contact, geom, phys) for the contacts of Law2_ScGeom_FrictViscoPhys_CundallStrackVisco that have a normal dashpot.
	template <class Visitor> void eachDashpot(Visitor&& visit) const
	{
		static Kind isFrictViscoPhys { "FrictViscoPhys" }, others[] { { "MindlinPhys" }, { "ViscElPhys" } };
		for (const auto& interaction : interactionsOf(this->scene)) {
			// Where only the bounds of a pair overlap there is no geom, and phys is from before, or none.
			void* const geom = interaction_geom(interaction).get();
			void* const phys = interaction_phys(interaction).get();
			if (!geom || !phys)
				continue;
			for (Kind& isOther : others)
				if (isOther(phys))
					refuse(pairName(interaction_id1(interaction.get()), interaction_id2(interaction.get())) + " has "
						+ className(phys),
					    text(
						"It is for dashpots of Law2_ScGeom_FrictViscoPhys_CundallStrackVisco only. Take that law, or remove ",
						Derived::name));
			if (isScGeom(geom) && isFrictViscoPhys(phys) && phys_cn(phys) > 0)
				visit(interaction.get(), geom, phys);
		}
	}

    private:
	void checkPlace() const
	{
		bool found = false, used = false;
		for (const auto& engine : scene_engines(this->scene)) {
			if (engine.get() == this)
				break;
			if (engine->dead)
				continue;
			const std::string other = engine->getClassName();
			if (found && !used && other.find("TimeStepper") != std::string::npos)
				refuse(text("a ", other,
					   " between InteractionLoop and it changes O.dt, to which the motion that it reads does not belong"),
				    "Put it right behind InteractionLoop in O.engines");
			found = found || other == "InteractionLoop";
			used = used || other == "NewtonIntegrator";
			if (other == Derived::name)
				refuse(
				    "there is another one before it, and each contact would be counted twice", "Remove one of them from O.engines");
		}
		if (!found)
			refuse("there is no InteractionLoop before it, which finds the forces", "Put it right behind InteractionLoop in O.engines");
		if (used)
			refuse("a NewtonIntegrator before it has used the forces already", "Put it right behind InteractionLoop in O.engines");
	}
};

} // namespace cd_engine
