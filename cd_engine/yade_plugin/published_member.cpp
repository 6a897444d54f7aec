#include "published_member.hpp"
#include "layout.hpp"
#include "safe_memory.hpp"

#include <boost/core/demangle.hpp>

namespace cd_engine {

namespace py = boost::python;

void refuse(const std::string& what, const std::string& expected, const std::string& found)
{
	throw LayoutError("cd_engine does not fit the running YADE: " + what + ": expected " + expected + ", found " + found
	    + ". Run the `yade` that Debian packages, in double precision; if this is it, rebuild with `make build`.");
}

long publishedOffset(const char* className, const char* member, const std::string& type)
{
	const std::string name = std::string(className) + "." + member;
	const py::object wrapper = py::import("yade.wrapper");
	if (!PyObject_HasAttrString(wrapper.ptr(), className))
		refuse(name, "a class published to Python", "none of that name");
	const py::object cls = wrapper.attr(className);
	if (!PyObject_HasAttrString(cls.ptr(), member))
		refuse(name, "a member published to Python", "none of that name");
	const py::object property = cls.attr(member);
	if (!PyObject_HasAttrString(property.ptr(), "fget"))
		refuse(name, "a data member", "an attribute of Python type " + std::string(Py_TYPE(property.ptr())->tp_name));
	const py::object getter = property.attr("fget");
	if (std::string(Py_TYPE(getter.ptr())->tp_name) != "Boost.Python.function")
		refuse(name, "a getter of Boost.Python", Py_TYPE(getter.ptr())->tp_name);

	// boost::python::objects::function is a Python object header and its py_function, whose only member points to the implementation.
	py::objects::py_function_impl_base* implementation = nullptr;
	if (!readMemory(reinterpret_cast<char*>(getter.ptr()) + sizeof(PyObject), implementation) || !implementation)
		refuse(name, "a getter of Boost.Python", "an empty one");
	const std::string kind = boost::core::demangle(typeid(*implementation).name());
	if (kind.find("boost::python::detail::member<") == std::string::npos)
		refuse(name, "a pointer-to-member of type " + type, "an accessor function");

	const py::detail::signature_element* signature = implementation->signature().signature;
	const std::string owner = std::string("yade::") + className;
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

} // namespace cd_engine
