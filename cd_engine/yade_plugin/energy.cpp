#include "energy.hpp"

namespace cd_engine {

double kineticEnergy(const cd::World& world)
{
	double sum = 0;
	for (const cd::Body& b : world.bodies)
		for (int k = 0; k < 3; k++)
			if (b.inverseMass[k] > 0)
				sum += 0.5 * b.v[k] * b.v[k] / b.inverseMass[k];
	return sum;
}

double weightEnergy(const cd::World& world, const Vector3r& gravity)
{
	double sum = 0;
	for (const cd::Body& b : world.bodies) {
		const double place[2] = { b.x, b.y };
		for (int k = 0; k < 2; k++)
			if (b.inverseMass[k] > 0)
				sum -= gravity[k] * place[k] / b.inverseMass[k];
	}
	return sum;
}

void track(double kinetic, double gravWork, double plastDissip)
{
	namespace py = boost::python;
	const PyGILState_STATE gil = PyGILState_Ensure();
	{
		py::object energy = py::import("yade").attr("O").attr("energy");
		const py::object known = energy.attr("keys")();
		const auto add = [&](const char* name, double value) {
			const bool there = PySequence_Contains(known.ptr(), py::str(name).ptr()) == 1;
			energy[name] = value + (there ? double(py::extract<double>(energy[name])) : 0);
		};
		energy["kinetic"] = kinetic;
		add("gravWork", gravWork);
		add("plastDissip", plastDissip);
	}
	PyGILState_Release(gil);
}

} // namespace cd_engine
