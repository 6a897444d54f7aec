#include "loaded_once.hpp"
#include "published_member.hpp"

#include <link.h>
#include <string>
#include <vector>

namespace cd_engine {
namespace {

	// Adds the file name of one loaded library to the list.
	int collect(dl_phdr_info* library, std::size_t, void* names)
	{
		const std::string path = library->dlpi_name;
		static_cast<std::vector<std::string>*>(names)->push_back(path.substr(path.rfind('/') + 1));
		return 0;
	}

} // namespace

void mustBeLoadedOnce()
{
	std::vector<std::string> names;
	dl_iterate_phdr(collect, &names);
	for (const std::string library : { "libboost_python", "libboost_serialization" }) {
		std::string found;
		int count = 0;
		for (const std::string& name : names)
			if (name.compare(0, library.size(), library) == 0) {
				found += (count++ ? " and " : "") + name;
			}
		if (count != 1)
			refuse(library, "one for YADE and for cd_engine", count ? found : "none");
	}
}

} // namespace cd_engine
