// The contacts of a system, a row each. Where they are those of the last step, and only gaps, normals and impulses have changed, a step may postpone
// the rows: sweeps then take the contacts from the step itself, and leave the impulses beside the rows, which nobody makes unless somebody needs
// them. This saves 13 % of a step of a packing at rest of 400 disks, and 20 to 30 % with 40 000.
#pragma once

#include "problem/contact_row.hpp"

#include <cassert>
#include <vector>

namespace cd {

// Knows the contacts of a system whose rows have not been made.
template <class Space> class RowSource {
    public:
	// All rows, with their first guesses.
	virtual void makeRows(std::vector<ContactRow<Space>>&) = 0;
	virtual ContactRow<Space> row(int32_t contact) const = 0;

    protected:
	~RowSource() = default;
};

template <class Space> class ContactRows {
	using ContactRow = cd::ContactRow<Space>;
	using RowSource = cd::RowSource<Space>;
	using Impulse = ImpulseOf<Space>;

    public:
	std::size_t size() const { return count; }
	bool empty() const { return count == 0; }

	// Only while no rows are postponed.
	ContactRow& operator[](std::size_t i) { return all()[i]; }
	const ContactRow& operator[](std::size_t i) const { return all()[i]; }
	auto begin() { return all().begin(); }
	auto end() { return all().end(); }
	auto begin() const { return all().begin(); }
	auto end() const { return all().end(); }
	ContactRow& back() { return all().back(); }
	void clear() { resize(0); }
	void push_back(const ContactRow& c)
	{
		all().push_back(c);
		count++;
	}
	bool compliant = false; // each contact has a stiffness
	bool pushing = true; // biases may push bodies apart (rebounds, a gap correction); else they are gaps, and the second order of turning faces

	// Rows that stay keep their numbers.
	void resize(std::size_t now)
	{
		count = now;
		all().resize(now);
	}
	std::vector<ContactRow>& all()
	{
		assert(!source);
		return rows;
	}
	const std::vector<ContactRow>& all() const
	{
		assert(!source);
		return rows;
	}

	// From now on `from` knows the rows, of which there are `now`. It must stay valid until they are made or forgotten.
	void postpone(RowSource& from, std::size_t now)
	{
		count = now;
		source = &from;
		solved = false;
		if (++unread == longestUnread)
			std::vector<ContactRow>().swap(rows); // a tenth of the memory of a step
	}
	const RowSource* postponed() const { return source; } // null: the rows are made
	// Makes the rows, with the impulses that sweeps have left. To be called before anybody reads a row of a system that a step has built.
	void make()
	{
		if (!source)
			return;
		unread = 0;
		rows.resize(count);
		source->makeRows(rows);
		source = nullptr;
		for (std::size_t i = 0; solved && i < rows.size(); i++)
			setImpulse(rows[i], impulses[i]);
	}
	// The rows cannot be made any more: those stored are of an earlier step.
	void forgetSource() { source = nullptr; }

	// While they are postponed: impulses beside the rows.
	Impulse* storeBeside()
	{
		solved = true;
		impulses.resize(count);
		return impulses.data();
	}
	const Impulse* solution() const { return impulses.data(); }
	bool solvedBeside() const { return source && solved; }
	void forgetSolution() { solved = false; }

    private:
	static constexpr int longestUnread = 16;
	std::size_t count = 0;
	std::vector<ContactRow> rows;
	int unread = 0; // steps in a row whose rows nobody has read
	RowSource* source = nullptr;
	std::vector<Impulse> impulses;
	bool solved = false;
};

} // namespace cd
