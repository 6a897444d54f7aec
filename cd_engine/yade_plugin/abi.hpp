// YADE's classes as far as the plug-in uses them. The declarations are derived from the binary itself (see layout.hpp).
//
// Nothing here is defined: every function and vtable is YADE's own, found in the running process. Virtual functions are declared in the order of the
// vtable relocations of libyade.so. The order is checked when the module loads, and again by tests/plugin.
#pragma once

#include <boost/enable_shared_from_this.hpp>
#include <boost/python.hpp>
#include <boost/shared_ptr.hpp>
#include <Eigen/Core>

#include <stdexcept>
#include <string>

template <class T> class Singleton {
    public:
	static T& instance();
};

namespace yade {

using Real = double;
using Vector3r = Eigen::Matrix<Real, 3, 1>;

// Opaque classes: their members are reached through layout.hpp.
class Body;
class State;
class Shape;
class Bound;
class Material;
class IGeom;
class IPhys;
class Scene;
class TimingDeltas;

class Factorable : public boost::enable_shared_from_this<Factorable> {
    public:
	virtual ~Factorable();
	virtual std::string getBaseClassName(unsigned i = 0) const;
	virtual int getBaseClassNumber() const;
	virtual std::string getClassName() const;
};

class Serializable : public Factorable {
    public:
	~Serializable() override;
	virtual void pySetAttr(const std::string& key, const boost::python::object& value);
	virtual boost::python::dict pyDict() const;
	virtual boost::python::dict pyDictCustom() const;
	virtual void callPostLoad();
	virtual bool checkPyClassRegistersItself(const std::string& name) const;
	virtual void pyRegisterClass(boost::python::object scope);
	virtual void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords);
	void pyUpdateAttrs(const boost::python::dict& attributes);
};

class Engine : public Serializable {
    public:
	Scene* scene; // set by YADE's loop before every call
	struct {
		long nExec;
		unsigned long long nsec;
	} timingInfo;
	boost::shared_ptr<TimingDeltas> timingDeltas;
	bool dead;
	int ompThreads;
	std::string label;

	Engine();
	~Engine() override;
	virtual bool isActivated();
	virtual void action();
};

class GlobalEngine : public Engine {
    public:
	GlobalEngine() { }
	~GlobalEngine() override;
	void pySetAttr(const std::string& key, const boost::python::object& value) override;
	boost::python::dict pyDict() const override;
	void callPostLoad() override;

	// Never called: Boost.Serialization's only instance for this class is YADE's, and its vtable leads to YADE's own code.
	template <class Archive> void serialize(Archive&, unsigned) { throw std::logic_error("YADE's serializer of GlobalEngine was not found"); }
};

class BodyContainer {
    public:
	boost::shared_ptr<Body>& operator[](unsigned id);
	std::size_t size() const;
	int insert(boost::shared_ptr<Body>);
};

class Interaction {
    public:
	void swapOrder();
};

class InteractionContainer {
    public:
	bool insert(int id1, int id2);
	const boost::shared_ptr<Interaction>& find(int id1, int id2);
	bool erase(int id1, int id2, int place); // place: its index in the list; the last interaction then moves there
};

class ForceContainer {
    public:
	ForceContainer();
	void sync();
	const Vector3r& getForce(int id);
	const Vector3r& getTorque(int id);
	void addForce(int id, const Vector3r&);
	void addTorque(int id, const Vector3r&);
};

class ClassFactory {
    public:
	bool registerFactorable(
	    std::string name, Factorable* (*create)(), boost::shared_ptr<Factorable> (*createShared)(), void* (*createPureCustom)());
	boost::shared_ptr<Factorable> createShared(std::string name);
};

class Omega {
    public:
	const boost::shared_ptr<Scene>& getScene() const;
	bool isInheritingFrom_recursive(const std::string& className, const std::string& baseClassName);
};

} // namespace yade
