// The solver's tolerance from step to step.
#include "step/step.hpp"

#include <doctest/doctest.h>

namespace {

cd::StepReport reportOf(double dissipated, double work)
{
	cd::StepReport report;
	report.dissipated = dissipated;
	report.work = 10 * dissipated;
	report.solver.work = work;
	return report;
}

} // namespace

TEST_CASE("rigid contacts: powers of ten of the flow's tolerance, never below the one of rest")
{
	const cd::StepTolerance rigid { true, 1e-6, 1e-3 };
	CHECK(rigid.next(1) == doctest::Approx(1e-3));
	CHECK(rigid.next(2e-4) == doctest::Approx(1e-4));
	CHECK(rigid.next(0) == 1e-6);
	CHECK(rigid.ofRest() == 1e-6);
	const cd::StepTolerance same { true, 1e-6, 1e-8 }; // the flow's tolerance has no meaning below the other
	CHECK(same.next(1) == 1e-6);
}

TEST_CASE("springs: a share of the motion, down to a limit")
{
	const cd::StepTolerance springs { false, 0.1, 1e-3 };
	CHECK(springs.next(2) == doctest::Approx(0.1));
	CHECK(springs.next(0.02) == doctest::Approx(1e-3));
	CHECK(springs.next(0) == springs.least());
	CHECK(springs.least() == doctest::Approx(1e-9));
	CHECK(springs.ofRest() == doctest::Approx(1e-7));
}

TEST_CASE("unrest rises at once and falls tenfold in 22 steps of rigid contacts, in 4 of springs")
{
	const cd::StepTolerance rigid { true, 1e-6, 1e-3 }, springs { false, 0.1, 0 };
	CHECK(rigid.unrest(1e-5, reportOf(2, 100)) == doctest::Approx(0.02));
	CHECK(springs.unrest(1e-5, reportOf(2, 100)) == doctest::Approx(0.2));
	double slow = 1, fast = 1;
	for (int k = 0; k < 22; k++)
		slow = rigid.unrest(slow, {});
	for (int k = 0; k < 4; k++)
		fast = springs.unrest(fast, {});
	CHECK(slow < 0.1);
	CHECK(slow / 0.9 > 0.1);
	CHECK(fast < 0.1);
	CHECK(fast / 0.5 > 0.1);
}
