#include "registered_engine.hpp"

namespace cd_engine {
namespace {

	struct ToPython {
		static PyObject* convert(const Matches& from)
		{
			if (!from.given())
				return py::incref(py::object().ptr());
			const py::object vector = py::import("yade.minieigenHP").attr("Vector3");
			py::list matches;
			for (std::size_t k = 0; k + 2 < from.matches.size(); k += 3)
				matches.append(vector(from.matches[k], from.matches[k + 1], from.matches[k + 2]));
			py::dict arguments;
			arguments["matches"] = matches;
			arguments["algo"] = from.algo;
			arguments["val"] = from.value;
			const py::object made = py::import("yade.wrapper").attr("MatchMaker")();
			made.attr("updateAttrs")(arguments);
			return py::incref(made.ptr());
		}
	};

	bool isMaker(PyObject* of) { return std::string(Py_TYPE(of)->tp_name) == "MatchMaker"; }

	void* convertible(PyObject* of)
	{
		return of == Py_None || isMaker(of) || (PyNumber_Check(of) && !PyBool_Check(of) && PyObject_HasAttrString(of, "__float__")) ? of
																	    : nullptr;
	}

	void construct(PyObject* of, py::converter::rvalue_from_python_stage1_data* data)
	{
		void* const place = reinterpret_cast<py::converter::rvalue_from_python_storage<Matches>*>(data)->storage.bytes;
		auto* const made = new (place) Matches;
		const py::object from { py::handle<>(py::borrowed(of)) };
		if (isMaker(of)) {
			made->algo = py::extract<std::string>(from.attr("algo"));
			made->value = py::extract<double>(from.attr("val"));
			const py::object matches = from.attr("matches");
			for (py::ssize_t i = 0; i < py::len(matches); i++)
				for (int k = 0; k < 3; k++)
					made->matches.push_back(py::extract<double>(matches[i][k]));
		} else if (of != Py_None) { // as YADE takes a number
			made->algo = "val";
			made->value = py::extract<double>(from.attr("__float__")());
		}
		data->convertible = place;
	}

} // namespace

void Matches::registerConverters()
{
	py::to_python_converter<Matches, ToPython>();
	py::converter::registry::push_back(&convertible, &construct, py::type_id<Matches>());
}

} // namespace cd_engine
