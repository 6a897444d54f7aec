#include "evidence.hpp"
#include "../bindings/python.hpp"

#include <boost/core/demangle.hpp>

#include <link.h>
#include <unistd.h>

namespace cd_engine {

void refuse(const std::string& what, const std::string& expected, const std::string& found)
{
	raise(PyExc_ImportError,
	    "cd_engine does not fit the running YADE: " + what + ": expected " + expected + ", found " + found
		+ ". Run the `yade` that Debian packages, in double precision; if this is it, rebuild with `make build`.");
}

bool readMemory(const void* from, void* to, std::size_t bytes)
{
	// The kernel copies through a pipe. For an invalid address it returns EFAULT, where a plain read would end the process.
	int ends[2];
	if (pipe(ends) != 0)
		return false;
	const auto all = static_cast<ssize_t>(bytes);
	const bool good = write(ends[1], from, bytes) == all && read(ends[0], to, bytes) == all;
	close(ends[0]);
	close(ends[1]);
	return good;
}

long publishedOffset(const std::string& className, const std::string& member, const std::string& type)
{
	const std::string name = className + "." + member, owner = "yade::" + className;
	// An attribute on the way to the getter.
	const auto attribute = [&](const py::object& of, const std::string& wanted, const std::string& expected, const std::string& otherwise) {
		if (!PyObject_HasAttrString(of.ptr(), wanted.c_str()))
			refuse(name, expected, otherwise);
		return py::object(of.attr(wanted.c_str()));
	};
	const auto pythonType = [](const py::object& of) { return std::string(Py_TYPE(of.ptr())->tp_name); };
	const py::object cls = attribute(py::import("yade.wrapper"), className, "a class published to Python", "none of that name");
	const py::object property = attribute(cls, member, "a member published to Python", "none of that name");
	const py::object getter = attribute(property, "fget", "a data member", "an attribute of Python type " + pythonType(property));
	if (pythonType(getter) != "Boost.Python.function")
		refuse(name, "a getter of Boost.Python", pythonType(getter));

	// boost::python::objects::function is a Python object header and its py_function, whose only member points to the implementation.
	py::objects::py_function_impl_base* implementation = nullptr;
	if (!readMemory(reinterpret_cast<char*>(getter.ptr()) + sizeof(PyObject), implementation) || !implementation)
		refuse(name, "a getter of Boost.Python", "an empty one");
	const std::string kind = boost::core::demangle(typeid(*implementation).name());
	if (kind.find("boost::python::detail::member<") == std::string::npos)
		refuse(name, "a pointer-to-member of type " + type, "an accessor function");

	const py::detail::signature_element* signature = implementation->signature().signature;
	if (signature[0].basename != type)
		refuse(name, "type " + type, std::string("type ") + signature[0].basename);
	if (signature[1].basename != owner)
		refuse(name, "a member of " + owner, std::string("a member of ") + signature[1].basename);

	// caller_py_function_impl is its vtable pointer and the pointer-to-member, which in this ABI is the offset.
	long offset = -1;
	if (!readMemory(reinterpret_cast<char*>(implementation) + sizeof(void*), offset) || offset < 0 || offset > 65536)
		refuse(name, "an offset within the object", std::to_string(offset));
	return offset;
}

void mustBeLoadedOnce()
{
	std::vector<std::string> names;
	const auto collect = [](dl_phdr_info* library, std::size_t, void* into) {
		const std::string path = library->dlpi_name;
		static_cast<std::vector<std::string>*>(into)->push_back(path.substr(path.rfind('/') + 1));
		return 0;
	};
	dl_iterate_phdr(collect, &names);
	for (const std::string library : { "libboost_python", "libboost_serialization" }) {
		std::string found;
		int count = 0;
		for (const std::string& name : names)
			if (name.compare(0, library.size(), library) == 0)
				found += (count++ ? " and " : "") + name;
		if (count != 1)
			refuse(library, "one for YADE and for cd_engine", count ? found : "none");
	}
}

} // namespace cd_engine
