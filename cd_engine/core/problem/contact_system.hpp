// The contact problem of one time step, formulated in the velocities of the bodies (matrix-free). Every solver works on it.
//
// Conventions, defined here and nowhere else (SI units throughout, plane motion in x, y, rotation about z):
//   n  unit normal from body `a` to body `b`;  t = (-n_y, n_x), n turned by +90 degrees
//   p  = (p_n, p_t) impulse [N s] on body `b`; body `a` takes -p.  Compression: p_n >= 0
//   u  = H^T v relative velocity [m/s] of `b` against `a` at the contact point, u_n < 0: closing
//   W  = H^T M^-1 H  Delassus operator [1/kg], never assembled; a contact knows only its own 2 x 2 block
// Contact law in one step (Signorini in velocity form and Coulomb; Jean 1999, Comput. Methods Appl. Mech. Eng. 177, eqs. 6 and 9):
//   0 <= u_n + bias  _|_  p_n >= 0,   |p_t| <= mu p_n,   p_t = -mu p_n u_t/|u_t| where the contact slides
// `bias` [m/s] carries the gap of the step (gap/h) or Newton's restitution (e u_n before the step).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace cd {

class Workspace;

// One cache line a body, because a contact needs the velocity and the inverse mass of a body together.
struct alignas(64) BodyVelocity {
	double v[3]; // v_x, v_y [m/s], angular velocity about z [rad/s]
	double pushed; // magnitude of the velocity change by the external force in the step [m/s]; 0 where it is not known
	double w[3]; // 1/m along x, 1/m along y [1/kg], 1/I [1/(kg m^2)]; 0 where the freedom is blocked
	double twisted; // the same for the angular velocity, by the external torque [rad/s]
};
static_assert(sizeof(BodyVelocity) == 64 && offsetof(BodyVelocity, w) == 32);

struct ContactRow {
	int32_t a = 0, b = 0; // indices of the bodies
	double nx = 0, ny = 0; // unit normal a -> b
	double an = 0, at = 0; // lever arms about the centre of `a`: cross(arm, n), cross(arm, t) [m]
	double bn = 0, bt = 0; // the same about the centre of `b` [m]
	double bias = 0; // [m/s], see above
	double mu = 0; // Coulomb friction coefficient
	double wnn = 0, wnt = 0, wtt = 0; // own block of W [1/kg]
	double pn = 0, pt = 0; // impulse on `b` [N s]: first guess on entry, solution on exit

	// Whether the normal and tangential directions are uncoupled: true for disks, and for boundaries whose free directions are along n or t.
	bool diagonal() const { return wnt == 0 && an == 0 && bn == 0; }

	// Whether neither body can move along the normal: the compliance `along` the normal is only round-off of the sum of `all` compliances.
	// Example: the normal of a body blocked along x, computed as (1, cos(pi/2)), has 6e-17 along y: an effective mass of 1e32 times its own.
	static constexpr double leastShare = 1e-29; // (14 epsilon)^2
	static bool held(double along, double all) { return along <= leastShare * all; }
	double freedom(const double* a, const double* b) const
	{
		return a[0] + a[1] + b[0] + b[1] + (an * an + at * at) * a[2] + (bn * bn + bt * bt) * b[2];
	}

	// Fills wnn, wnt, wtt from the arms and the inverse masses of the bodies. wnn = 0 if both are immobile along n; solvers skip such contacts.
	void assembleBlock(const BodyVelocity& A, const BodyVelocity& B)
	{
		// The arms of a body that does not and cannot turn have no effect. Zero arms allow the faster kernel for uncoupled contacts.
		if (A.w[2] == 0 && A.v[2] == 0)
			an = at = 0;
		if (B.w[2] == 0 && B.v[2] == 0)
			bn = bt = 0;
		const double wx = A.w[0] + B.w[0], wy = A.w[1] + B.w[1];
		wnn = nx * nx * wx + ny * ny * wy + an * an * A.w[2] + bn * bn * B.w[2];
		wtt = ny * ny * wx + nx * nx * wy + at * at * A.w[2] + bt * bt * B.w[2];
		wnt = nx * ny * (wy - wx) + an * at * A.w[2] + bn * bt * B.w[2];
		if (wnn > 0 && held(wnn, freedom(A.w, B.w)))
			wnn = wnt = pn = pt = 0;
	}
};
static_assert(sizeof(ContactRow) == 8 + 13 * 8 && offsetof(ContactRow, at) == 32 && offsetof(ContactRow, mu) == 64 && offsetof(ContactRow, pn) == 96);

struct Group;

// Knows the contacts of a system whose rows have not been made.
class RowSource {
    public:
	virtual ~RowSource() = default;
	// All rows, with their first guesses.
	virtual void makeRows(std::vector<ContactRow>&) = 0;
	virtual ContactRow row(int32_t contact) const = 0;
	// The first guess of a contact.
	virtual std::array<double, 2> guess(int32_t contact) const = 0;
	// Writes contacts straight into the lanes of `count` groups (group.hpp), eight a group. inverseRadius: of every body, one over its radius of
	// gyration. Sets a bit of `left` for each lane that only row() can tell, and for every empty lane (-1).
	virtual void fill(const int32_t* contacts, std::size_t count, const double* inverseRadius, Group* groups, uint8_t* left) const = 0;
};

// The contacts of a system. Where they are those of the last step, and only gaps, normals and impulses have changed, sweeps take them from the step
// itself, and the rows are made only if somebody reads one. Not thread-safe before they are made.
class ContactRows {
    public:
	std::size_t size() const { return count; }
	bool empty() const { return count == 0; }
	void resize(std::size_t now)
	{
		count = now;
		if (!rows.empty())
			rows.resize(now);
	}
	void clear() { resize(0); }
	void push_back(const ContactRow& c)
	{
		all().push_back(c);
		count++;
	}
	ContactRow& back() { return all().back(); }
	ContactRow& operator[](std::size_t i) { return all()[i]; }
	const ContactRow& operator[](std::size_t i) const { return all()[i]; }
	ContactRow* data() { return all().data(); }
	auto begin() { return all().begin(); }
	auto end() { return all().end(); }
	auto begin() const { return std::as_const(all()).begin(); }
	auto end() const { return std::as_const(all()).end(); }

	// `from` must stay valid until the next step, or until the rows are made.
	void postpone(RowSource* from)
	{
		source = from;
		solved = false;
		if (++unread == longestUnread)
			std::vector<ContactRow>().swap(rows); // a tenth of the memory of a step
	}
	// From now on the rows cannot be made; if they were postponed, the stored ones are those of an earlier step.
	void forgetSource()
	{
		source = nullptr;
		solved = false;
	}
	const RowSource* postponed() const { return source; } // null: the rows are made
	void make() const { (void)all(); }
	std::vector<ContactRow>& all() const
	{
		if (source)
			makeAll();
		else if (rows.size() != count)
			rows.resize(count);
		return rows;
	}

	// Until they are made: impulses beside the rows, two a contact. Sweeps leave their result there.
	double* storeBeside()
	{
		solved = true;
		impulses.resize(2 * count);
		return impulses.data();
	}
	const double* solution() const { return impulses.data(); }
	bool solvedBeside() const { return source && solved; }
	void forgetSolution() { solved = false; }

    private:
	void makeAll() const
	{
		unread = 0;
		rows.resize(count);
		source->makeRows(rows);
		source = nullptr;
		for (std::size_t i = 0; solved && i < rows.size(); i++) {
			rows[i].pn = impulses[2 * i];
			rows[i].pt = impulses[2 * i + 1];
		}
	}

	static constexpr int longestUnread = 16;
	std::size_t count = 0;
	mutable std::vector<ContactRow> rows; // not kept where nobody reads them
	mutable int unread = 0; // steps in a row whose rows nobody has read
	mutable RowSource* source = nullptr;
	std::vector<double> impulses;
	bool solved = false;
};

struct ContactSystem {
	std::vector<std::array<double, 2>> places; // of the bodies' centres [m]; empty where they are not known
	std::vector<BodyVelocity> bodies; // v: the free velocity (after external forces) on entry, the solution on exit
	ContactRows contacts; // solvers may sweep them in any order but must not reorder them
	Workspace* memory = nullptr; // for those who work on it (workspace.hpp); null: they allocate their own each time
	// Systems with the same memory and the same number have contacts between the same bodies, of the same masses. 0: nothing is known.
	std::size_t contactSet = 0;

	void assembleBlocks()
	{
		for (ContactRow& c : contacts)
			c.assembleBlock(bodies[c.a], bodies[c.b]);
	}
};

// u_n and u_t of one contact for the bodies' present velocities.
inline void relativeVelocity(const ContactRow& c, const BodyVelocity& A, const BodyVelocity& B, double& un, double& ut)
{
	const double dx = B.v[0] - A.v[0], dy = B.v[1] - A.v[1];
	un = c.nx * dx + c.ny * dy + c.bn * B.v[2] - c.an * A.v[2];
	ut = c.nx * dy - c.ny * dx + c.bt * B.v[2] - c.at * A.v[2];
}

// Adds the impulse (pn, pt) on `b` and its reaction on `a`.
inline void applyImpulse(const ContactRow& c, BodyVelocity& A, BodyVelocity& B, double pn, double pt)
{
	const double px = c.nx * pn - c.ny * pt, py = c.ny * pn + c.nx * pt;
	A.v[0] -= A.w[0] * px;
	A.v[1] -= A.w[1] * py;
	A.v[2] -= A.w[2] * (c.an * pn + c.at * pt);
	B.v[0] += B.w[0] * px;
	B.v[1] += B.w[1] * py;
	B.v[2] += B.w[2] * (c.bn * pn + c.bt * pt);
}

} // namespace cd
