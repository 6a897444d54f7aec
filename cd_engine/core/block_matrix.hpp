// A sparse matrix of B x B blocks with a symmetric pattern, factorized many times over with one pattern, by KLU (Davis & Natarajan 2010,
// ACM Trans. Math. Softm. 37, 36) of SuiteSparse.
//
// KLU orders by approximate minimum degree once a pattern, chooses pivots once, and repeats the elimination with the same pivots for new
// numbers; it calls no BLAS and starts no thread, so that its bits are the same in every process. One factorization of three rows a disk on
// one core (AMD EPYC; medians of seven; packing and lattice of 400 disks, lattice of 3600): 0.46, 1.0 and 55 ms. Beside it UMFPACK takes
// 1.7, 2.5 and 66 ms, Eigen::SparseLU 4.2, 2.6 and 91 ms, and CHOLMOD's simplicial method, which can do the symmetric part only (without
// sliding contacts), 0.62, 0.79 and 36 ms.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <suitesparse/klu.h>
#include <utility>
#include <vector>

namespace cd {

template <int B> class BlockMatrix {
    public:
	using Block = std::array<double, B * B>; // row by row

	BlockMatrix()
	{
		klu_defaults(&settings);
		settings.flops = 0;
	}
	~BlockMatrix() { release(); }
	BlockMatrix(const BlockMatrix&) = delete;
	BlockMatrix& operator=(const BlockMatrix&) = delete;

	// pairs: the places (i, j), i != j, that may be filled besides the diagonal; (j, i) is implied, and repeats do no harm.
	void plan(std::size_t rows, const std::vector<std::pair<int32_t, int32_t>>& pairs);

	// All blocks are zero.
	void clear();
	// The block at row i, column j, which is on the diagonal or among the pairs, to be added to.
	Block& at(int32_t i, int32_t j);

	// False where the matrix is singular to working precision.
	bool factorize();
	// x: right-hand side on entry, solution on exit.
	void solve(std::vector<double>& x);

	std::size_t rows() const { return blocks; }
	// Floating-point operations of the last factorization; KLU makes 3e9 a second.
	double operations() const { return settings.flops; }

    private:
	void release();
	void copyValues();

	std::size_t blocks = 0; // in a row
	// Column j holds the blocks start[j] .. start[j + 1] - 1, rows ascending; the same by single columns and numbers for KLU.
	std::vector<std::size_t> start;
	std::vector<int32_t> row;
	std::vector<Block> block;
	std::vector<int> numberStart, numberRow;
	std::vector<double> number;
	klu_common settings;
	klu_symbolic* order = nullptr;
	klu_numeric* factors = nullptr;
};

} // namespace cd
