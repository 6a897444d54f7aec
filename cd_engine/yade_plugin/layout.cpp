#include "layout.hpp"
#include "../bindings/python.hpp"
#include "scene_error.hpp"

#include <boost/core/demangle.hpp>

#include <array>
#include <cstring>
#include <dlfcn.h>
#include <link.h>
#include <unistd.h>

namespace cd_engine {
// Raises the ImportError of every refusal, which says what was checked, expected and found, and what to do.
[[noreturn]] static void refuse(const std::string& what, const std::string& expected, const std::string& found)
{
	raise(PyExc_ImportError,
	    "cd_engine does not fit the running YADE: " + what + ": expected " + expected + ", found " + found
		+ ". Run the `yade` that Debian packages, in double precision; if this is it, rebuild with `make build`.");
}

// Reads up to 4096 bytes of this process that may not exist: returns false instead of crashing.
static bool readMemory(const void* from, void* to, std::size_t bytes)
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

template <class T> static bool readMemory(const void* from, T& to) { return readMemory(from, &to, sizeof(T)); }

// Offset in bytes of a class member, read from YADE's Boost.Python registration. It must be published by pointer-to-member with this C++ type.
static long publishedOffset(const std::string& className, const std::string& member, const std::string& type)
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

// Boost.Python and Boost.Serialization keep what is registered with them inside the library. A plug-in linked to another version than YADE would
// register its engines where YADE never looks. Refuses a process that has not loaded exactly one version of each.
static void mustBeLoadedOnce()
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

namespace {

	// One run over all members: what was claimed, what was confirmed.
	struct Survey {
		const py::dict& claims;
		py::list entries {};

		// What a test claims of `name`, or else what is so by ourselves.
		template <class T> T claimed(const std::string& name, const T& own) const
		{
			const py::object claim = claims.get(name, py::object());
			const py::extract<T> value(claim);
			return value.check() ? value() : own;
		}

		void confirm(
		    bool holds, const std::string& name, long offset, const std::string& expected, const std::string& found = "something else")
		{
			if (!holds)
				refuse(name, expected, found);
			entries.append(py::make_tuple(name, offset));
		}

		void confirmSame(const std::string& name, long expected, long found, const std::string& what = "offset ")
		{
			confirm(expected == found, name, found, what + std::to_string(expected), what + std::to_string(found));
		}

		// own: where our compiler has placed the member, -1 if it knows nothing of it.
		long published(const std::string& owner, const std::string& member, const std::string& type, long own = -1)
		{
			const std::string name = owner + "." + member;
			const long offset = publishedOffset(owner, member, claimed(name, type));
			confirmSame(name, claimed(name, own < 0 ? offset : own), offset);
			return offset;
		}

		// holds(offset): whether the declared offset is that of the member, which `expected` describes.
		template <class Test> void declared(const AnyMember& member, const std::string& expected, const Test& holds)
		{
			const std::string name = std::string(member.owner) + "." + member.name;
			const long offset = claimed(name, member.offset);
			const bool plausible = offset >= 0 && offset <= 4096;
			confirm(plausible && holds(offset), name, offset, text("at offset ", offset, " ", expected));
		}
	};

	// The first of a class's virtual functions, found by an exported symbol of YADE's.
	void** vtable(const char* name)
	{
		void* const address = dlsym(RTLD_DEFAULT, name);
		if (!address)
			refuse("symbol " + std::string(name), "exported by libyade.so", "not there");
		return static_cast<void**>(address) + 2;
	}

	// Whether the object at `object` has the given class's vtable; never touches memory that is not mapped.
	bool hasVtable(const void* object, const char* name)
	{
		void* found = nullptr;
		return readMemory(object, found) && found == vtable(name);
	}

	Shared<yade::Factorable> make(const char* className)
	{
		Shared<yade::Factorable> object = Singleton<yade::ClassFactory>::instance().createShared(className);
		if (!object)
			refuse(className, "a class YADE can create", "none of that name");
		return object;
	}

	char* address(const py::object& of) { return reinterpret_cast<char*>(py::extract<yade::Serializable*>(of)()); }

	// The plug-in takes a pointer to an object for one to its Factorable and back: that base must come first.
	void surveyBases(Survey& s)
	{
		for (const char* const owner : { "Body", "State", "Interaction", "ScGeom", "ScGeom6D", "FrictPhys", "FrictViscoPhys", "CohFrictPhys",
			 "FrictMat", "CohFrictMat", "Sphere", "Box", "Wall", "Facet", "Bo1_Sphere_Aabb", "InsertionSortCollider", "Scene" }) {
			const std::string name = std::string(owner) + ".Factorable";
			const Shared<yade::Factorable> object = make(owner);
			const long offset = reinterpret_cast<char*>(object.get()) - static_cast<char*>(dynamic_cast<void*>(object.get()));
			s.confirmSame(name, s.claimed(name, 0L), offset);
		}
	}

	// State: written through Python's accessors, read at the declared offsets, with two values, since memory may hold one of them by chance.
	void surveyState(Survey& s)
	{
		using Vector = std::array<double, 3>;
		using Quaternion = std::array<double, 4>; // x, y, z, w
		const py::object minieigen = py::import("yade.minieigenHP");
		py::object state = py::import("yade.wrapper").attr("State")();
		const auto holds = [&](const AnyMember& member, const auto& asPython, const auto& first, const auto& second) {
			s.declared(member, "the values just set from Python", [&](long offset) {
				const auto arrives = [&](const auto& value) {
					auto found = value;
					state.attr(member.name) = asPython(value);
					return readMemory(address(state) + offset, found) && found == value;
				};
				return arrives(first) && arrives(second);
			});
		};
		const auto vector = [&](const Vector& v) { return minieigen.attr("Vector3")(v[0], v[1], v[2]); };
		const auto quaternion = [&](const Quaternion& q) { return minieigen.attr("Quaternion")(q[3], q[0], q[1], q[2]); };
		const auto letters = [](unsigned dofs) {
			std::string of;
			for (int k = 0; k < 6; k++)
				if (dofs >> k & 1)
					of += "xyzXYZ"[k];
			return of;
		};
		holds(state_pos, vector, Vector { 1.25, -2.5, 3.75 }, Vector { -0.5, 6.25, 1.5 });
		holds(state_ori, quaternion, Quaternion { 0.36, 0.48, 0, 0.8 }, Quaternion { 0, 0.6, 0.48, 0.64 });
		holds(state_blockedDOFs, letters, 2u | 4 | 8, 1u | 32);
	}

	// A force container at `place` must be built like a fresh one, word by word, with pointers where pointers are.
	bool looksLikeForceContainer(const char* place)
	{
		using Words = std::array<unsigned long, 64>; // more than it has
		// Built on two different backgrounds, so that words the constructor does not write (padding, what lies behind) are told from others.
		alignas(16) static Words fresh[2]; // never destroyed: a few bytes stay with the process
		Words found;
		fresh[0].fill(0xA5A5A5A5A5A5A5A5);
		fresh[1].fill(0x5A5A5A5A5A5A5A5A);
		for (Words& words : fresh)
			new (static_cast<void*>(&words)) yade::ForceContainer();
		if (!readMemory(place, found))
			return false;
		const auto isPointer = [](unsigned long word) {
			char target;
			return readMemory(reinterpret_cast<void*>(word), target);
		};
		std::size_t compared = 0, pointers = 0;
		for (std::size_t i = 0; i < found.size(); i++) {
			const bool same = fresh[0][i] == fresh[1][i], pointer = isPointer(fresh[0][i]) && isPointer(fresh[1][i]);
			if (pointer ? !isPointer(found[i]) : same && found[i] != fresh[0][i])
				return false;
			compared += same && !pointer;
			pointers += pointer;
		}
		return compared > 12 && pointers > 6;
	}

	// Scene and its containers, on a scene of our own, so that the user's is not touched.
	void surveyScene(Survey& s)
	{
		const Shared<yade::Factorable> scene = make("Scene");
		char* const raw = reinterpret_cast<char*>(scene.get());
		const auto container = [&](const AnyMember& member, const char* vtableName) {
			void* object = nullptr;
			s.declared(member, "a pointer to its container",
			    [&](long offset) { return readMemory(raw + offset, object) && hasVtable(object, vtableName); });
			return object;
		};
		auto* const bodies = static_cast<yade::BodyContainer*>(container(scene_bodies, "_ZTVN4yade13BodyContainerE"));
		auto* const interactions
		    = static_cast<yade::InteractionContainer*>(container(scene_interactions, "_ZTVN4yade20InteractionContainerE"));
		s.declared(scene_forces, "a force container", [&](long offset) { return looksLikeForceContainer(raw + offset); });

		// Inserting a body sets the current scene's doSort; put it back, so that importing the module changes no run.
		bool& doSort = scene_doSort(Singleton<yade::Omega>::instance().getScene().get());
		const bool sorting = doSort;
		for (int i = 0; i < 3; i++)
			bodies->insert(boost::reinterpret_pointer_cast<yade::Body>(make("Body")));
		doSort = sorting;
		if (bodies->size() != 3 || body_id((*bodies)[2].get()) != 2)
			refuse(
			    "BodyContainer", "three bodies after three insertions, the last with id 2", std::to_string(bodies->size()) + " bodies");

		interactions->insert(0, 1);
		interactions->insert(1, 2);
		s.declared(interactions_linear, "the two interactions just inserted", [&](long offset) {
			char *range[2] = { nullptr, nullptr }, *last = nullptr;
			int ids[2] = { -1, -1 };
			constexpr long each = sizeof(Shared<yade::Interaction>);
			return readMemory(reinterpret_cast<char*>(interactions) + offset, range) && range[1] - range[0] == 2 * each
			    && readMemory(range[0] + each, last) && hasVtable(last, "_ZTVN4yade11InteractionE")
			    && readMemory(last + interaction_id1, ids[0]) && readMemory(last + interaction_id2, ids[1]) && ids[0] == 1 && ids[1] == 2;
		});
	}

	// The list of engines, which YADE publishes by accessor only: compared, one by one, with what that accessor gives.
	void surveyEngines(Survey& s)
	{
		py::object scene = py::import("yade").attr("O");
		const py::object before = scene.attr("engines");
		// An empty list would confirm any place that holds zeros.
		py::list filled;
		filled.append(py::import("yade.wrapper").attr("ForceResetter")());
		const bool empty = py::len(before) == 0;
		if (empty)
			scene.attr("engines") = filled;
		const py::object expected = scene.attr("engines");
		constexpr long each = sizeof(Shared<yade::Engine>);
		char* range[2] = { nullptr, nullptr };
		const char* const raw = reinterpret_cast<const char*>(Singleton<yade::Omega>::instance().getScene().get());
		bool same
		    = readMemory(raw + s.claimed<long>("Scene.engines", scene_engines), range) && range[1] - range[0] == py::len(expected) * each;
		for (py::ssize_t i = 0; same && i < py::len(expected); i++) {
			char* found = nullptr;
			same = readMemory(range[0] + i * each, found) && found == address(expected[i]);
		}
		if (empty)
			scene.attr("engines") = before;
		s.declared(scene_engines, "the engines that O.engines names", [&](long) { return same; });
	}

	// The base class we derive from: its size, its members as the compiler placed them.
	void surveyEngine(Survey& s)
	{
		const Shared<yade::Factorable> made = make("GlobalEngine");
		yade::GlobalEngine own; // laid out by our compiler, constructed by YADE's code
		const auto placed = [&](const auto& member) { return reinterpret_cast<const char*>(&member) - reinterpret_cast<const char*>(&own); };
		s.published("Engine", "timingDeltas", py::type_id<Shared<yade::TimingDeltas>>().name(), placed(own.timingDeltas));
		s.published("Engine", "dead", py::type_id<bool>().name(), placed(own.dead));
		s.published("Engine", "ompThreads", py::type_id<int>().name(), placed(own.ompThreads));
		s.published("Engine", "label", py::type_id<std::string>().name(), placed(own.label));

		// PeriodicEngine derives from GlobalEngine and from nothing else; its first own member starts where the base ends.
		const std::string size = "GlobalEngine.sizeof";
		s.confirmSame(size, s.claimed<long>(size, sizeof own), periodic_virtPeriod, "the first member of a derived class at ");

		s.declared(AnyMember { "Engine", "scene", "", false, placed(own.scene) }, "the current scene", [&](long offset) {
			void* current = nullptr;
			return readMemory(reinterpret_cast<char*>(made.get()) + offset, current)
			    && current == Singleton<yade::Omega>::instance().getScene().get();
		});
		py::object engine = py::import("yade.wrapper").attr("GlobalEngine")();
		engine.attr("execTime") = 4711;
		s.declared(
		    AnyMember { "Engine", "timingInfo", "", false, placed(own.timingInfo) }, "the time just set from Python", [&](long offset) {
			    unsigned long long nsec = 0;
			    return readMemory(address(engine) + offset + 8, nsec) && nsec == 4711;
		    });
	}

	// Virtual functions of GlobalEngine in the order abi.hpp declares them.
	const char* const virtualFunctions[] = {
		"_ZN4yade12GlobalEngineD1Ev",
		"_ZN4yade12GlobalEngineD0Ev",
		"_ZNK4yade12GlobalEngine16getBaseClassNameB5cxx11Ej",
		"_ZNK4yade12GlobalEngine18getBaseClassNumberEv",
		"_ZNK4yade12GlobalEngine12getClassNameB5cxx11Ev",
		"_ZN4yade12GlobalEngine9pySetAttrERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEERKN5boost6python3api6objectE",
		"_ZNK4yade12GlobalEngine6pyDictEv",
		"_ZNK4yade12Serializable12pyDictCustomEv",
		"_ZN4yade12GlobalEngine12callPostLoadEv",
		"_ZNK4yade12Serializable27checkPyClassRegistersItselfERKNSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEE",
		"_ZN4yade12GlobalEngine15pyRegisterClassEN5boost6python3api6objectE",
		"_ZN4yade12Serializable22pyHandleCustomCtorArgsERN5boost6python5tupleERNS2_4dictE",
		"_ZN4yade6Engine11isActivatedEv",
		"_ZN4yade6Engine6actionEv",
	};

	void surveyVtable(Survey& s)
	{
		void** const slots = vtable("_ZTVN4yade12GlobalEngineE");
		for (long i = 0; i < static_cast<long>(std::size(virtualFunctions)); i++) {
			const std::string name = "GlobalEngine.vtable[" + std::to_string(i) + "]";
			const std::string function = s.claimed<std::string>(name, virtualFunctions[i]);
			void* slot = nullptr;
			readMemory(slots + i, slot);
			Dl_info info {};
			dladdr(slot, &info);
			// Weak functions may have one copy in each library; all of them are reached by this name, the slot holds the first.
			void* const expected = dlsym(RTLD_DEFAULT, function.c_str());
			s.confirm(expected && slot == expected, name, i, function, info.dli_sname ? info.dli_sname : "an unnamed function");
		}
	}

} // namespace

py::list establishLayout(const py::dict& claims)
{
	Survey survey { claims };
	mustBeLoadedOnce();
	surveyVtable(survey);
	surveyBases(survey);
	for (AnyMember* const member : AnyMember::all)
		if (member->published)
			member->offset = survey.published(member->owner, member->name, member->type);
	surveyEngine(survey);
	surveyState(survey);
	surveyScene(survey);
	surveyEngines(survey);
	const py::object looked = py::dict(survey.entries);
	for (py::stl_input_iterator<std::string> claim(claims), end; claim != end; ++claim)
		if (!looked.contains(*claim))
			raise(PyExc_ImportError, "no member named " + *claim + " is looked up");
	return survey.entries;
}

} // namespace cd_engine
