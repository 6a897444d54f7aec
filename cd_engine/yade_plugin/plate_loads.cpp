#include "contact_dynamics.hpp"
#include "plate_loads.hpp"
#include "kind.hpp"
#include "waiting.hpp"

#include <cmath>

namespace cd_engine {
namespace {

	constexpr double pi = 3.141592653589793;
	const char* const axisName[] = { "x", "y", "z" };

} // namespace

const char* const PlateLoads::documentation
    = "Loads the plates around a sample, Box or Wall perpendicular to the axes, as TriaxialStressController does, but by forces instead of a servo, "
      "so that the same engine serves springs and :py:class:`ContactDynamics`. By axis it holds a stress, by forces on the plates that are free to "
      "move along it (state.mass, and state.blockedDOFs such as 'yzXYZ'), or a strain rate, by the velocity of plates that are not free. "
      "Signs are those of TriaxialStressController: tension and extension are positive. The stress acts on the area between the other plates. It "
      "stands between ForceResetter and NewtonIntegrator or ContactDynamics.";

template <class Visitor> void PlateLoads::attributes(Visitor&& visit)
{
	using P = PlateLoads;
	visit("plates", &P::plates, setting,
	    "Ids of the plates: the lower and the upper one of x, y and z, as :yref:`yade.utils.aabbWalls` makes them. -1, or a shorter list: none.");
	visit(
	    "stressMask", &P::stressMask, within(0, 7), "Bits 1, 2 and 4: *goals* is a stress along x, y and z; without the bit a strain rate [1].");
	visit("goals", &P::goals, setting, "Stress [Pa] or rate of the true strain [1/s] along x, y and z; negative: compression.");
	visit("loading", &P::loading, setting,
	    "How the goals change with the time t = O.time: goals (1 + rise s(t)). constant: s = 0; ramp: s = t; cosine: s = (1 - cos(2 pi "
	    "t/period))/2; "
	    "triangle: s rises linearly to 1 in half a period and falls back; smoothStep: s = (1 - cos(pi t/period))/2, from t = period on 1. The "
	    "goal of a step is that of its middle with ContactDynamics, of its end if contacts have a stiffness there, and of its beginning with "
	    "springs, "
	    "at which the leapfrog scheme wants it.");
	visit("rise", &P::rise, setting, "Share of its goal by which each axis changes [1]; with the ramp the same a second [1/s].");
	visit("period", &P::period, Access { Access::set, 0, 1e300, true }, "Period of *loading* [s].");
	visit("holdMean", &P::holdMean, setting,
	    "Of two axes with stresses, let the one whose *rise* is 0 change by as much as the other, but in the other direction, so that the mean "
	    "stress stays.");
	visit("depth", &P::depth, Access { Access::set, 0, 1e300, true }, "Length of the sample along an axis that has no plates [m].");
	visit("symmetric", &P::symmetric, setting, "A strain rate moves both plates of its axis; else only the upper one.");
	visit("goal", &P::goal, result, "The goals of the last step [Pa], [1/s].");
	visit("strain", &P::strain, result,
	    "True strain along x, y and z since the first step with these *plates*, at the beginning of the last one [1].");
	visit("work", &P::work, result,
	    "Work of the forces on the plates from the first step to the beginning of the last one [J]. What moves plates at a strain rate is not in "
	    "it, nor the step before a pause of this engine and what happens in the pause.");
	visit("steps", &P::steps, result, "Steps made [1].");
	visit("faces", &P::faces, internal, "Places of the plates' inner faces at the beginning of the last step [m].");
	visit("pushes", &P::pushes, internal, "Forces on the plates in the last step [N].");
	visit("speeds", &P::speeds, internal, "Velocities that the last step has given to the plates, 0 if none [m/s].");
	visit("lastPlates", &P::lastPlates, internal, "The plates of the last step.");
	visit("lastStep", &P::lastStep, internal, "Number of the scene's step that was the last one.");
	visit("firstLengths", &P::firstLengths, internal, "Lengths of the sample at the beginning of the first step [m].");
}

std::string PlateLoads::wordFault(const char*, const std::string& value)
{
	for (const char* known : { "constant", "ramp", "cosine", "triangle", "smoothStep" })
		if (value == known)
			return "";
	return "='" + value + "' is not known; there is 'constant', 'ramp', 'cosine', 'triangle', 'smoothStep'";
}

void PlateLoads::refuse(const std::string& what, const std::string& remedy) { throw SceneError(text(name, ": ", what, ". ", remedy)); }

void PlateLoads::action()
{
	try {
		step();
	} catch (const std::exception& error) {
		exchangeError(error.what());
		throw;
	}
}

// Whether ContactDynamics moves the bodies. A load then holds throughout its step. Also checks this engine's place.
bool PlateLoads::isImplicit()
{
	static Kind resets { "ForceResetter" }, springs { "NewtonIntegrator" }, rigid { "ContactDynamics" }, controls { "BoundaryController" };
	bool reset = false, passed = false;
	servo = false;
	for (const auto& engine : scene_engines(scene)) {
		if (engine.get() == this)
			passed = true;
		else if (!engine->dead && (springs(engine.get()) || rigid(engine.get()))) {
			if (!passed)
				refuse(
				    "it stands behind the engine that moves the bodies", "Put it between ForceResetter and that engine in O.engines");
			if (!reset)
				refuse("no ForceResetter stands before it, so forces would add up", "Put one in front of it in O.engines");
			const auto* const implicit = dynamic_cast<const ContactDynamics*>(engine.get());
			atEnd = implicit && implicit->isCompliant();
			return rigid(engine.get());
		} else if (!engine->dead) {
			reset = reset || (!passed && resets(engine.get()));
			servo = servo || controls(engine.get());
		}
	}
	refuse("no engine behind it moves the bodies", "Put NewtonIntegrator or ContactDynamics behind it in O.engines");
}

// State and inner face of a plate.
void* PlateLoads::plate(std::size_t place, int axis, double& face)
{
	static Kind isBox { "Box" }, isWall { "Wall" };
	const int id = plates[place];
	auto& container = *scene_bodies(scene);
	const Shared<yade::Body> body = id < static_cast<int>(container.size()) ? container[id] : nullptr;
	if (!body || !body_shape(body) || !body_state(body))
		refuse(text("there is no body #", id, ", which plates names"), "Set plates to the ids of Box or Wall bodies, -1 for none");
	void *const shape = body_shape(body).get(), *const state = body_state(body).get();
	const bool box = isBox(shape);
	if (!box && !(isWall(shape) && wall_axis(shape) == axis))
		refuse(text("body #", id, " is no Box, and no Wall perpendicular to ", axisName[axis]), "Set plates to those that are");
	if (box && std::abs(std::abs((&state_ori(state))[3]) - 1) > 1e-9)
		refuse(text("plate #", id, " is turned"), "Make the Box without an orientation, with its sides along the axes");
	face = state_pos(state)[axis] + (box ? (place % 2 ? -1 : 1) * box_extents(shape)[axis] : 0);
	return state;
}

double PlateLoads::riseAt(int axis, double t) const
{
	if (loading == "ramp")
		return rise[axis] * t;
	if (loading == "cosine")
		return rise[axis] / 2 * (1 - std::cos(2 * pi * t / period));
	if (loading == "triangle")
		return rise[axis] * (1 - std::abs(1 - 2 * std::fmod(t / period, 1.0)));
	if (loading == "smoothStep")
		return rise[axis] / 2 * (1 - std::cos(pi * std::min(t / period, 1.0)));
	return 0;
}

// A stress is that of loadTime, a velocity, which lasts throughout the step, that of its middle.
Vector3r PlateLoads::goalsAt(double loadTime, double middle, const std::array<Axis, 3>& axes) const
{
	Vector3r now;
	for (int k = 0; k < 3; k++)
		now[k] = goals[k] * (1 + riseAt(k, isStress(k) ? loadTime : middle));
	if (!holdMean)
		return now;
	int held = -1, led = -1;
	for (int k = 0; k < 3; k++)
		if (axes[k].given() && isStress(k) && goals[k] != 0)
			(rise[k] == 0 ? held : led) = k;
	if (held >= 0 && led >= 0)
		now[held] = goals[held] + goals[led] - now[led];
	return now;
}

void PlateLoads::step()
{
	const std::lock_guard<std::mutex> lock(attributesLock);
	const bool implicit = isImplicit();
	const double dt = scene_dt(scene);
	std::array<Axis, 3> axes;
	Vector3r length = Vector3r::Constant(depth);
	std::vector<double> facesNow(6), pushesNow(6), speedsNow(6);
	if (plates.size() > 6)
		refuse(text("plates has ", plates.size(), " ids"), "Give at most six: the lower and the upper plate of x, y and z, -1 for none");
	for (int k = 0; k < 3; k++) {
		const std::size_t low = 2 * k, high = low + 1;
		if (high >= plates.size() || plates[low] < 0 || plates[high] < 0) {
			if (goals[k] != 0)
				refuse(text("goals has ", goals[k], " along ", axisName[k], ", where plates names no two plates"),
				    "Name the lower and the upper one, or set that goal to 0");
			continue;
		}
		axes[k].low = plate(low, k, facesNow[low]);
		axes[k].high = plate(high, k, facesNow[high]);
		length[k] = facesNow[high] - facesNow[low];
		if (length[k] <= 0) // a NaN is told where the run is watched
			refuse(text("plates #", plates[low], " and #", plates[high], " have met along ", axisName[k]),
			    "In plates give the lower one first; a sample that collapses needs an end of its run");
	}
	const double middle = scene_time(scene) + dt / 2;
	goal = goalsAt(!implicit ? scene_time(scene) : atEnd ? scene_time(scene) + dt : middle, middle, axes);
	seen.clear();
	for (int k = 0; k < 3; k++) {
		if (!axes[k].given())
			continue;
		seen.insert(seen.end(), { plates[2 * k], plates[2 * k + 1] });
		const bool stress = isStress(k);
		const double area = length[(k + 1) % 3] * length[(k + 2) % 3], force = goal[k] * area;
		bool pushed = false;
		for (int side = 0; side < 2; side++) {
			void* const state = side ? axes[k].high : axes[k].low;
			const int id = plates[2 * k + side];
			const bool isFree = !(state_blockedDOFs(state) >> k & 1);
			if (stress && isFree) {
				pushed = true;
				pushesNow[2 * k + side] = side ? force : -force;
				Vector3r push = Vector3r::Zero();
				push[k] = pushesNow[2 * k + side];
				scene_forces(scene).addForce(id, push);
			} else if (!stress && (side == 1 || symmetric)) {
				if (isFree)
					refuse(text("plate #", id, " is free along ", axisName[k], ", where a strain rate is its goal"),
					    text("Block '", axisName[k], "' in its state.blockedDOFs, or set the bit of the axis in stressMask"));
				// So that the true strain grows by goal dt in this step.
				const double opening = std::expm1(goal[k] * dt) / dt * length[k];
				speedsNow[2 * k + side] = state_vel(state)[k] = (side ? 1 : -1) * (symmetric ? opening / 2 : opening);
			}
		}
		if (stress && !pushed && goal[k] != 0 && !servo)
			refuse(text("neither of the plates #", plates[2 * k], " and #", plates[2 * k + 1], " is free along ", axisName[k]),
			    text("Give one a state.mass and take '", axisName[k],
				"' out of its state.blockedDOFs, or clear the bit of the axis in stressMask"));
	}
	stopPlates(speedsNow);
	const bool same = steps > 0 && plates == lastPlates;
	if (!same)
		firstLengths.assign(length.data(), length.data() + 3);
	if (same && lastStep == scene_iter(scene) - 1) {
		// In the leapfrog scheme a force acts from half a step before to half a step after.
		double done = 0;
		for (int i = 0; i < 6; i++)
			done += (implicit ? pushes[i] : (pushes[i] + pushesNow[i]) / 2) * (facesNow[i] - faces[i]);
		work += done;
	}
	for (int k = 0; k < 3; k++)
		strain[k] = axes[k].given() ? std::log(length[k] / firstLengths[k]) : 0;
	faces = facesNow;
	pushes = pushesNow;
	speeds = speedsNow;
	lastPlates = plates;
	lastStep = scene_iter(scene);
	steps++;
}

// A blocked plate keeps its velocity: where a strain rate no longer moves it, it stops, unless somebody has given it another velocity.
void PlateLoads::stopPlates(const std::vector<double>& speedsNow)
{
	for (std::size_t i = 0; i < lastPlates.size(); i++) {
		const int id = lastPlates[i], k = static_cast<int>(i) / 2;
		if (speeds[i] == 0 || (speedsNow[i] != 0 && plates[i] == id))
			continue;
		auto& container = *scene_bodies(scene);
		const Shared<yade::Body> body = id < static_cast<int>(container.size()) ? container[id] : nullptr;
		void* const state = body ? body_state(body).get() : nullptr;
		if (!state || !(state_blockedDOFs(state) >> k & 1) || state_vel(state)[k] != speeds[i])
			continue;
		state_vel(state)[k] = 0;
		seen.push_back(id);
	}
}

template class RegisteredEngine<PlateLoads>;

} // namespace cd_engine

CD_ENGINE_REGISTER(PlateLoads)
