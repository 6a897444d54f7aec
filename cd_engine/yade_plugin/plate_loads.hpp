// Loads on the plates around a sample, for springs and for Contact Dynamics alike.
#pragma once

#include "registered_engine.hpp"

#include <array>

namespace cd_engine {

class PlateLoads : public RegisteredEngine<PlateLoads> {
    public:
	static constexpr const char* name = "PlateLoads";
	static const char* const documentation;

	std::vector<int> plates { 0, 1, 2, 3, 4, 5 };
	Vector3r goals = Vector3r::Zero();
	int stressMask = 7;
	std::string loading = "constant";
	Vector3r rise = Vector3r::Zero();
	double period = 1;
	bool holdMean = false;
	double depth = 1;
	bool symmetric = false;
	// Left by the last step.
	Vector3r goal = Vector3r::Zero(), strain = Vector3r::Zero();
	double work = 0; // [J]
	long steps = 0;
	std::vector<double> faces, pushes, speeds = std::vector<double>(6), firstLengths;
	std::vector<int> lastPlates;
	long lastStep = -1;

	template <class Visitor> static void attributes(Visitor&& visit);
	static std::string wordFault(const char* attribute, const std::string& value);

	void action() override;
	// The plates of the last step, which it has pushed, moved, or looked at. ContactDynamics reads them anew in every step, and shows where they
	// are.
	const std::vector<int>& looksAt() const { return seen; }

    private:
	// The two plates of an axis, if it has both.
	struct Axis {
		void *low = nullptr, *high = nullptr; // State
		bool given() const { return low; }
	};

	[[noreturn]] static void refuse(const std::string& what, const std::string& remedy);
	void step();
	void stopPlates(const std::vector<double>& speedsNow);
	bool isImplicit();
	bool atEnd = false; // the load of a step is that of its end
	void* plate(std::size_t place, int axis, double& face);
	Vector3r goalsAt(double loadTime, double middle, const std::array<Axis, 3>&) const;
	bool isStress(int axis) const { return stressMask >> axis & 1; }
	double riseAt(int axis, double time) const;

	bool servo = false; // whether YADE's controller moves the plates to the goals
	std::vector<int> seen;
};

extern template class RegisteredEngine<PlateLoads>;

} // namespace cd_engine
