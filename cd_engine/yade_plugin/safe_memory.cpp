#include "safe_memory.hpp"

#include <algorithm>
#include <unistd.h>

namespace cd_engine {

bool readMemory(const void* from, void* to, std::size_t bytes)
{
	// The kernel copies through a pipe. For an invalid address it returns EFAULT, where a plain read would end the process.
	int ends[2];
	if (pipe(ends) != 0)
		return false;
	bool good = true;
	for (std::size_t done = 0; good && done < bytes;) {
		const std::size_t part = std::min<std::size_t>(bytes - done, 4096);
		good = write(ends[1], static_cast<const char*>(from) + done, part) == static_cast<ssize_t>(part)
		    && read(ends[0], static_cast<char*>(to) + done, part) == static_cast<ssize_t>(part);
		done += part;
	}
	close(ends[0]);
	close(ends[1]);
	return good;
}

} // namespace cd_engine
