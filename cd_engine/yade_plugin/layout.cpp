#include "layout.hpp"
#include "loaded_once.hpp"
#include "published_member.hpp"
#include "safe_memory.hpp"

#include <algorithm>
#include <cstring>
#include <dlfcn.h>

namespace cd_engine {

Layout layout;

namespace {

	namespace py = boost::python;
	template <class T> using Shared = boost::shared_ptr<T>;

	using Entries = std::vector<std::pair<std::string, long>>;

	// One run over all members: what was claimed, what was found.
	struct Survey {
		const std::map<std::string, Lie>& lies;
		Layout found {};
		Entries entries {};

		template <class T> void published(long Layout::*slot, const char* className, const char* member)
		{
			const std::string name = std::string(className) + "." + member;
			std::string type = py::type_id<T>().name();
			const auto lie = lies.find(name);
			if (lie != lies.end() && !lie->second.type.empty())
				type = lie->second.type;
			const long offset = publishedOffset(className, member, type);
			if (lie != lies.end() && lie->second.offset >= 0 && lie->second.offset != offset)
				refuse(name, "offset " + std::to_string(lie->second.offset), "offset " + std::to_string(offset));
			found.*slot = offset;
			entries.emplace_back(name, offset);
		}

		// The offset to be confirmed by the caller.
		long declared(const std::string& name, long offset)
		{
			const auto lie = lies.find(name);
			if (lie != lies.end() && lie->second.offset >= 0)
				offset = lie->second.offset;
			entries.emplace_back(name, offset);
			return offset;
		}
	};

	void surveyPublished(Survey& s)
	{
		using yade::Vector3r;
		s.published<double>(&Layout::scene_dt, "Scene", "dt");
		s.published<long>(&Layout::scene_iter, "Scene", "iter");
		s.published<long>(&Layout::scene_stopAtIter, "Scene", "stopAtIter");
		s.published<bool>(&Layout::scene_isPeriodic, "Scene", "isPeriodic");
		s.published<bool>(&Layout::scene_trackEnergy, "Scene", "trackEnergy");
		s.published<int>(&Layout::body_id, "Body", "id");
		s.published<Shared<yade::Material>>(&Layout::body_material, "Body", "material");
		s.published<Shared<yade::State>>(&Layout::body_state, "Body", "state");
		s.published<Shared<yade::Shape>>(&Layout::body_shape, "Body", "shape");
		s.published<Shared<yade::Bound>>(&Layout::body_bound, "Body", "bound");
		s.published<int>(&Layout::body_clumpId, "Body", "clumpId");
		s.published<int>(&Layout::body_flags, "Body", "flags");
		s.published<int>(&Layout::body_groupMask, "Body", "groupMask");
		s.published<Vector3r>(&Layout::state_vel, "State", "vel");
		s.published<Vector3r>(&Layout::state_angVel, "State", "angVel");
		s.published<Vector3r>(&Layout::state_inertia, "State", "inertia");
		s.published<double>(&Layout::state_mass, "State", "mass");
		s.published<int>(&Layout::interaction_id1, "Interaction", "id1");
		s.published<int>(&Layout::interaction_id2, "Interaction", "id2");
		s.published<long>(&Layout::interaction_iterMadeReal, "Interaction", "iterMadeReal");
		s.published<Shared<yade::IGeom>>(&Layout::interaction_geom, "Interaction", "geom");
		s.published<Shared<yade::IPhys>>(&Layout::interaction_phys, "Interaction", "phys");
		s.published<Vector3r>(&Layout::geom_normal, "GenericSpheresContact", "normal");
		s.published<Vector3r>(&Layout::geom_contactPoint, "GenericSpheresContact", "contactPoint");
		s.published<double>(&Layout::geom_refR1, "GenericSpheresContact", "refR1");
		s.published<double>(&Layout::geom_refR2, "GenericSpheresContact", "refR2");
		s.published<double>(&Layout::geom_penetrationDepth, "ScGeom", "penetrationDepth");
		s.published<Vector3r>(&Layout::geom_shearInc, "ScGeom", "shearInc");
		s.published<double>(&Layout::phys_kn, "NormPhys", "kn");
		s.published<Vector3r>(&Layout::phys_normalForce, "NormPhys", "normalForce");
		s.published<double>(&Layout::phys_ks, "NormShearPhys", "ks");
		s.published<Vector3r>(&Layout::phys_shearForce, "NormShearPhys", "shearForce");
		s.published<double>(&Layout::phys_tangensOfFrictionAngle, "FrictPhys", "tangensOfFrictionAngle");
		s.published<double>(&Layout::phys_cn, "FrictViscoPhys", "cn");
		s.published<Vector3r>(&Layout::phys_normalViscous, "FrictViscoPhys", "normalViscous");
		s.published<Vector3r>(&Layout::bound_min, "Bound", "min");
		s.published<Vector3r>(&Layout::bound_max, "Bound", "max");
		s.published<int>(&Layout::collider_avoidSelfInteractionMask, "Collider", "avoidSelfInteractionMask");
		s.published<bool>(&Layout::collider_doSort, "InsertionSortCollider", "doSort");
		s.published<double>(&Layout::periodic_virtPeriod, "PeriodicEngine", "virtPeriod");
		s.published<double>(&Layout::periodic_realPeriod, "PeriodicEngine", "realPeriod");
		s.published<long>(&Layout::periodic_iterPeriod, "PeriodicEngine", "iterPeriod");
		s.published<long>(&Layout::periodic_nDone, "PeriodicEngine", "nDone");
		s.published<long>(&Layout::periodic_iterLast, "PeriodicEngine", "iterLast");
		s.published<double>(&Layout::sphere_radius, "Sphere", "radius");
		s.published<Vector3r>(&Layout::box_extents, "Box", "extents");
		s.published<int>(&Layout::wall_sense, "Wall", "sense");
		s.published<int>(&Layout::wall_axis, "Wall", "axis");
		s.published<double>(&Layout::frictMat_frictionAngle, "FrictMat", "frictionAngle");
	}

	// The address of an exported symbol of YADE's.
	void* symbol(const char* name)
	{
		void* address = dlsym(RTLD_DEFAULT, name);
		if (!address)
			refuse("symbol " + std::string(name), "exported by libyade.so", "not there");
		return address;
	}

	// Whether the object at `object` has the given class's vtable; never touches memory that is not mapped.
	bool hasVtable(const void* object, const char* vtableSymbol)
	{
		void* found = nullptr;
		return readMemory(object, found) && found == static_cast<char*>(symbol(vtableSymbol)) + 16;
	}

	Shared<yade::Factorable> make(const char* className)
	{
		Shared<yade::Factorable> object = Singleton<yade::ClassFactory>::instance().createShared(className);
		if (!object)
			refuse(className, "a class YADE can create", "none of that name");
		return object;
	}

	// The plug-in takes a pointer to an object for one to its Factorable and back: that base must come first.
	void surveyBases(Survey& s)
	{
		for (const char* const name : { "Body", "State", "Interaction", "ScGeom", "FrictPhys", "FrictViscoPhys", "FrictMat", "Sphere", "Box",
			 "Wall", "Bo1_Sphere_Aabb", "InsertionSortCollider", "Scene" }) {
			const Shared<yade::Factorable> object = make(name);
			const long offset = reinterpret_cast<char*>(object.get()) - static_cast<char*>(dynamic_cast<void*>(object.get()));
			const long expected = s.declared(std::string(name) + ".Factorable", 0);
			if (offset != expected)
				refuse(std::string(name) + ".Factorable", "offset " + std::to_string(expected), "offset " + std::to_string(offset));
		}
	}

	// State: written through Python's accessors, read at the declared offsets.
	void surveyState(Survey& s)
	{
		using yade::Vector3r;
		const py::object wrapper = py::import("yade.wrapper"), minieigen = py::import("yade.minieigenHP");
		py::object state = wrapper.attr("State")();
		char* raw = static_cast<char*>(static_cast<void*>(py::extract<yade::Serializable*>(state)()));

		state.attr("pos") = minieigen.attr("Vector3")(1.25, -2.5, 3.75);
		const double turned[4] = { 0.36, 0.48, 0, 0.8 }; // x, y, z, w: a unit quaternion
		state.attr("ori") = minieigen.attr("Quaternion")(turned[3], turned[0], turned[1], turned[2]);
		state.attr("blockedDOFs") = "yzX";

		const auto holds = [&](const char* member, long offset, const void* expected, std::size_t bytes) {
			std::vector<char> found(bytes);
			if (offset < 0 || !readMemory(raw + offset, found.data(), bytes) || std::memcmp(found.data(), expected, bytes) != 0)
				refuse(std::string("State.") + member, "at offset " + std::to_string(offset) + " the value just set from Python",
				    "something else");
		};
		const double position[3] = { 1.25, -2.5, 3.75 };
		const unsigned dofs = 2 | 4 | 8;
		s.found.state_se3 = s.declared("State.pos", 88);
		holds("pos", s.found.state_se3, position, sizeof position);
		s.found.state_orientation = s.declared("State.ori", 112);
		holds("ori", s.found.state_orientation, turned, sizeof turned);
		s.found.state_blockedDOFs = s.declared("State.blockedDOFs", 304);
		holds("blockedDOFs", s.found.state_blockedDOFs, &dofs, sizeof dofs);
	}

	// A force container at `place` must be built byte by byte like a fresh one, with pointers where pointers are.
	bool looksLikeForceContainer(const char* place)
	{
		constexpr std::size_t words = 64; // more than it has
		union Bytes {
			unsigned long word[words];
			unsigned char byte[8 * words];
		};
		// Built on two different backgrounds, so that bytes the constructor does not write (padding, what lies behind) are told from others.
		alignas(16) static Bytes fresh[2]; // never destroyed: a few bytes stay with the process
		Bytes found;
		for (const int i : { 0, 1 }) {
			std::fill(std::begin(fresh[i].byte), std::end(fresh[i].byte), i ? 0x5A : 0xA5);
			new (static_cast<void*>(&fresh[i])) yade::ForceContainer();
		}
		if (!readMemory(place, found))
			return false;
		std::size_t compared = 0, pointers = 0;
		for (std::size_t i = 0; i < words; i++) {
			char target;
			if (readMemory(reinterpret_cast<void*>(fresh[0].word[i]), target)
			    && readMemory(reinterpret_cast<void*>(fresh[1].word[i]), target)) {
				if (!readMemory(reinterpret_cast<void*>(found.word[i]), target))
					return false;
				pointers++;
				continue;
			}
			for (std::size_t k = 8 * i; k < 8 * i + 8; k++) {
				if (fresh[0].byte[k] != fresh[1].byte[k])
					continue;
				if (fresh[0].byte[k] != found.byte[k])
					return false;
				compared++;
			}
		}
		return compared > 100 && pointers > 6;
	}

	// The list of engines, which YADE publishes by accessor only: compared, one by one, with what that accessor gives.
	void surveyEngines(Survey& s)
	{
		s.found.scene_engines = s.declared("Scene.engines", 552);
		py::object scene = py::import("yade").attr("O");
		const py::object before = scene.attr("engines");
		// An empty list would confirm any place that holds zeros.
		py::list filled;
		filled.append(py::import("yade.wrapper").attr("ForceResetter")());
		const bool empty = py::len(before) == 0;
		if (empty)
			scene.attr("engines") = filled;
		const py::object expected = scene.attr("engines");
		char* range[2] = { nullptr, nullptr };
		const char* const raw = reinterpret_cast<const char*>(Singleton<yade::Omega>::instance().getScene().get());
		bool same = s.found.scene_engines >= 0 && s.found.scene_engines < 4096 && readMemory(raw + s.found.scene_engines, range, sizeof range)
		    && range[1] - range[0] == py::len(expected) * static_cast<long>(sizeof(Shared<yade::Engine>));
		for (py::ssize_t i = 0; same && i < py::len(expected); i++) {
			const yade::Engine* found = nullptr;
			same = readMemory(range[0] + i * sizeof(Shared<yade::Engine>), found)
			    && found == &py::extract<const yade::Engine&>(expected[i])();
		}
		if (empty)
			scene.attr("engines") = before;
		if (!same)
			refuse("Scene.engines", "at offset " + std::to_string(s.found.scene_engines) + " the engines that O.engines names",
			    "something else");
	}

	// Scene and its containers, on a scene of our own, so that the user's is not touched.
	void surveyScene(Survey& s)
	{
		const Shared<yade::Factorable> scene = make("Scene");
		char* raw = reinterpret_cast<char*>(scene.get());

		const auto container = [&](const char* member, long offset, const char* vtable) {
			void* object = nullptr;
			if (offset < 0 || offset > 4096 || !readMemory(raw + offset, object) || !hasVtable(object, vtable))
				refuse(std::string("Scene.") + member, "at offset " + std::to_string(offset) + " a pointer to its container",
				    "something else");
			return object;
		};
		s.found.scene_bodies = s.declared("Scene.bodies", 600);
		auto* bodies = static_cast<yade::BodyContainer*>(container("bodies", s.found.scene_bodies, "_ZTVN4yade13BodyContainerE"));
		s.found.scene_interactions = s.declared("Scene.interactions", 616);
		auto* interactions = static_cast<yade::InteractionContainer*>(
		    container("interactions", s.found.scene_interactions, "_ZTVN4yade20InteractionContainerE"));

		s.found.scene_forces = s.declared("Scene.forces", 32);
		if (s.found.scene_forces < 0 || s.found.scene_forces > 4096 || !looksLikeForceContainer(raw + s.found.scene_forces))
			refuse("Scene.forces", "at offset " + std::to_string(s.found.scene_forces) + " a force container", "something else");

		// Inserting a body sets the current scene's doSort; put it back, so that importing the module changes no run.
		const long doSort = publishedOffset("Scene", "doSort", py::type_id<bool>().name());
		void* const current = Singleton<yade::Omega>::instance().getScene().get();
		const bool sorting = at<bool>(current, doSort);
		for (int i = 0; i < 3; i++) {
			const Shared<yade::Factorable> body = make("Body");
			bodies->insert(Shared<yade::Body>(body, reinterpret_cast<yade::Body*>(body.get())));
		}
		at<bool>(current, doSort) = sorting;
		if (bodies->size() != 3 || at<int>((*bodies)[2].get(), s.found.body_id) != 2)
			refuse(
			    "BodyContainer", "three bodies after three insertions, the last with id 2", std::to_string(bodies->size()) + " bodies");

		interactions->insert(0, 1);
		interactions->insert(1, 2);
		s.found.interactions_linear = s.declared("InteractionContainer.linear", 24);
		char* const place = reinterpret_cast<char*>(interactions) + s.found.interactions_linear;
		char *range[2] = { nullptr, nullptr }, *last = nullptr;
		int ids[2] = { -1, -1 };
		if (!readMemory(place, range, sizeof range) || range[1] - range[0] != 2 * static_cast<long>(sizeof(Shared<yade::Interaction>))
		    || !readMemory(range[0] + sizeof(Shared<yade::Interaction>), last) || !hasVtable(last, "_ZTVN4yade11InteractionE")
		    || !readMemory(last + s.found.interaction_id1, ids[0]) || !readMemory(last + s.found.interaction_id2, ids[1]) || ids[0] != 1
		    || ids[1] != 2)
			refuse("InteractionContainer.linear",
			    "at offset " + std::to_string(s.found.interactions_linear) + " the two interactions just inserted", "something else");
	}

	// The base class we derive from: its size, its members as the compiler placed them, its virtual functions.
	void surveyEngine(Survey& s)
	{
		const Shared<yade::Factorable> made = make("GlobalEngine");
		yade::GlobalEngine own; // laid out by our compiler, constructed by YADE's code
		const auto placed = [&](const char* member, const void* address) {
			return std::make_pair(member, static_cast<long>(static_cast<const char*>(address) - reinterpret_cast<const char*>(&own)));
		};

		const auto compare = [&](const std::pair<const char*, long>& mine, const std::string& type) {
			const std::string name = std::string("Engine.") + mine.first;
			const auto lie = s.lies.find(name);
			const long claimed = lie != s.lies.end() && lie->second.offset >= 0 ? lie->second.offset : mine.second;
			const long offset
			    = publishedOffset("Engine", mine.first, lie != s.lies.end() && !lie->second.type.empty() ? lie->second.type : type);
			if (offset != claimed)
				refuse(name, "offset " + std::to_string(claimed), "offset " + std::to_string(offset));
			s.entries.emplace_back(name, offset);
		};
		compare(placed("timingDeltas", &own.timingDeltas), py::type_id<Shared<yade::TimingDeltas>>().name());
		compare(placed("dead", &own.dead), py::type_id<bool>().name());
		compare(placed("ompThreads", &own.ompThreads), py::type_id<int>().name());
		compare(placed("label", &own.label), py::type_id<std::string>().name());

		// PeriodicEngine derives from GlobalEngine and from nothing else; its first own member starts where the base ends.
		const long size = s.declared("GlobalEngine.sizeof", sizeof(yade::GlobalEngine));
		const long next = publishedOffset("PeriodicEngine", "virtPeriod", py::type_id<double>().name());
		if (next != size)
			refuse("GlobalEngine.sizeof", std::to_string(size) + " bytes", "a derived class's first member at " + std::to_string(next));

		const long pointer = s.declared("Engine.scene", placed("scene", &own.scene).second);
		void* current = nullptr;
		if (pointer < 0 || pointer > size - 8 || !readMemory(reinterpret_cast<char*>(made.get()) + pointer, current)
		    || current != Singleton<yade::Omega>::instance().getScene().get())
			refuse("Engine.scene", "at offset " + std::to_string(pointer) + " the current scene", "something else");

		py::object engine = py::import("yade.wrapper").attr("GlobalEngine")();
		engine.attr("execTime") = 4711;
		const long nsec = s.declared("Engine.timingInfo", placed("timingInfo", &own.timingInfo).second);
		unsigned long long read = 0;
		if (!readMemory(static_cast<char*>(static_cast<void*>(py::extract<yade::Serializable*>(engine)())) + nsec + 8, read) || read != 4711)
			refuse("Engine.timingInfo", "at offset " + std::to_string(nsec) + " the time just set from Python", std::to_string(read));
	}

	// Virtual functions of GlobalEngine in the order abi.hpp declares them, as mangled names without their class's part.
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
		void** const slots = reinterpret_cast<void**>(static_cast<char*>(symbol("_ZTVN4yade12GlobalEngineE")) + 16);
		for (long i = 0; i < static_cast<long>(std::size(virtualFunctions)); i++) {
			const std::string name = "GlobalEngine.vtable[" + std::to_string(i) + "]";
			const auto lie = s.lies.find(name);
			const char* function = lie != s.lies.end() && !lie->second.type.empty() ? lie->second.type.c_str() : virtualFunctions[i];
			void* slot = nullptr;
			readMemory(slots + i, slot);
			// Weak functions may have one copy in each library; all of them are reached by this name, the slot holds the first.
			void* const expected = dlsym(RTLD_DEFAULT, function);
			if (!expected || slot != expected) {
				Dl_info info {};
				dladdr(slot, &info);
				refuse(name, function, info.dli_sname ? info.dli_sname : "an unnamed function");
			}
			s.entries.emplace_back(name, i);
		}
	}

	Entries confirmed;

} // namespace

void establishLayout(const std::map<std::string, Lie>& lies)
{
	Survey survey { lies };
	mustBeLoadedOnce();
	surveyVtable(survey);
	surveyBases(survey);
	surveyPublished(survey);
	surveyEngine(survey);
	surveyState(survey);
	surveyScene(survey);
	surveyEngines(survey);
	for (const auto& lie : lies) {
		const auto known = [&](const auto& entry) { return entry.first == lie.first; };
		if (std::none_of(survey.entries.begin(), survey.entries.end(), known))
			throw LayoutError("no member named " + lie.first + " is looked up");
	}
	layout = survey.found;
	confirmed = survey.entries;
}

std::vector<std::pair<std::string, long>> layoutEntries() { return confirmed; }

} // namespace cd_engine
