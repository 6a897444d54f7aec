#include "newton/block_matrix.hpp"

#include <algorithm>
#include <cassert>
#include <new>

namespace cd {
namespace {

	// Ratio of the smallest to the largest pivot below which no digit of the solution is known.
	constexpr double singular = 1e-15;
	// Pivots are chosen anew if the old ones let numbers grow by more than this. Larger growth would cost too many digits.
	constexpr double growth = 1e6;

} // namespace

template <int B> void BlockMatrix<B>::release()
{
	klu_free_numeric(&factors, &settings);
	klu_free_symbolic(&order, &settings);
}

template <int B> void BlockMatrix<B>::plan(std::size_t rows, const std::vector<std::pair<int32_t, int32_t>>& pairs)
{
	assert(std::all_of(pairs.begin(), pairs.end(), [n = static_cast<int32_t>(rows)](const auto& p) { return p.first < n && p.second < n; }));
	release();
	blocks = rows;
	std::vector<std::pair<int32_t, int32_t>> places; // column, row
	places.reserve(rows + 2 * pairs.size());
	for (std::size_t i = 0; i < rows; i++)
		places.emplace_back(static_cast<int32_t>(i), static_cast<int32_t>(i));
	for (const auto& [i, j] : pairs) {
		places.emplace_back(i, j);
		places.emplace_back(j, i);
	}
	std::sort(places.begin(), places.end());
	places.erase(std::unique(places.begin(), places.end()), places.end());
	start.assign(rows + 1, 0);
	row.clear();
	for (const auto& [column, i] : places) {
		row.push_back(i);
		start[static_cast<std::size_t>(column) + 1] = row.size();
	}
	block.resize(places.size());
	number.resize(B * B * places.size());
	numberStart.assign(1, 0);
	numberRow.clear();
	for (std::size_t j = 0; j < rows; j++)
		for (int c = 0; c < B; c++) {
			for (std::size_t k = start[j]; k < start[j + 1]; k++)
				for (int r = 0; r < B; r++)
					numberRow.push_back(B * row[k] + r);
			numberStart.push_back(static_cast<int>(numberRow.size()));
		}
	// No scaling, since callers scale their rows. No search for a block triangular form, since the contacts of a packing are connected.
	settings.scale = 0;
	settings.btf = 0;
	if (rows > 0 && !(order = klu_analyze(static_cast<int>(B * rows), numberStart.data(), numberRow.data(), &settings)))
		throw std::bad_alloc(); // the pattern is valid, so only memory can be missing
}

template <int B> typename BlockMatrix<B>::Block& BlockMatrix<B>::at(int32_t i, int32_t j)
{
	const auto first = row.begin() + static_cast<std::ptrdiff_t>(start[static_cast<std::size_t>(j)]);
	const auto end = row.begin() + static_cast<std::ptrdiff_t>(start[static_cast<std::size_t>(j) + 1]);
	const auto found = std::lower_bound(first, end, i);
	assert(found != end && *found == i);
	return block[static_cast<std::size_t>(found - row.begin())];
}

template <int B> bool BlockMatrix<B>::factorize()
{
	if (blocks == 0)
		return true;
	int *columns = numberStart.data(), *rows = numberRow.data();
	double *const values = number.data(), *to = values;
	for (std::size_t j = 0; j < blocks; j++)
		for (std::size_t c = 0; c < B; c++)
			for (std::size_t k = start[j]; k < start[j + 1]; k++)
				for (std::size_t r = 0; r < B; r++)
					*to++ = block[k][B * r + c];
	const bool again = factors && klu_refactor(columns, rows, values, order, factors, &settings) && settings.status == KLU_OK
	    && klu_rgrowth(columns, rows, values, order, factors, &settings) && settings.rgrowth * growth > 1;
	if (!again) {
		klu_free_numeric(&factors, &settings);
		factors = klu_factor(columns, rows, values, order, &settings);
		if (factors)
			klu_flops(order, factors, &settings);
	}
	return factors && settings.status == KLU_OK && klu_rcond(order, factors, &settings) && settings.rcond > singular;
}

template <int B> void BlockMatrix<B>::solve(std::vector<double>& x)
{
	assert(x.size() == B * blocks);
	if (blocks > 0)
		klu_solve(order, factors, static_cast<int>(B * blocks), 1, x.data(), &settings);
}

template class BlockMatrix<2>;
template class BlockMatrix<3>;

} // namespace cd
