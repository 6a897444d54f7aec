// A value by pair of materials, as YADE's MatchMaker states it.
#pragma once

#include "layout.hpp"

#include <boost/serialization/nvp.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace cd_engine {

struct Matches {
	std::string algo; // of pairs that match nothing; empty: no MatchMaker is given
	double value = 0; // MatchMaker.val
	std::vector<double> matches; // ids of two materials and their value, three numbers a match

	bool given() const { return !algo.empty(); }
	// The value of a pair of materials, from the values of its two if no match has it.
	double of(int id1, int id2, double value1, double value2) const
	{
		for (std::size_t k = 0; k + 2 < matches.size(); k += 3)
			if ((matches[k] == id1 && matches[k + 1] == id2) || (matches[k] == id2 && matches[k + 1] == id1))
				return matches[k + 2];
		return algo == "val"	? value
		    : algo == "zero"	? 0
		    : algo == "avg"	? (value1 + value2) / 2
		    : algo == "max"	? std::max(value1, value2)
		    : algo == "harmAvg" ? (value1 + value2 > 0 ? 2 * value1 * value2 / (value1 + value2) : 0)
					: std::min(value1, value2);
	}
	// Calls see(value) for every value that does not come from the materials.
	template <class See> void each(const See& see) const
	{
		for (std::size_t k = 2; k < matches.size(); k += 3)
			see(matches[k]);
		if (algo == "val")
			see(value);
	}
	bool operator==(const Matches& o) const { return algo == o.algo && (value == o.value || algo != "val") && matches == o.matches; }

	template <class Archive> void serialize(Archive& archive, unsigned)
	{
		using boost::serialization::make_nvp;
		archive& make_nvp("algo", algo) & make_nvp("value", value) & make_nvp("matches", matches);
	}

	// Makes Python's MatchMaker, numbers and None from these and these from them.
	static void registerConverters();
};

} // namespace cd_engine
