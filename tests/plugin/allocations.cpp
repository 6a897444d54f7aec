// Who asks for memory: a library to be preloaded, which notes the calls of every request made between countStart() and countStop(), or refuses one.
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <execinfo.h>

extern "C" {
// The C library's own, under the names it keeps for this.
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
}

namespace {

constexpr int depth = 24, most = 4096;

struct Request {
	void* callers[depth];
	int count;
	long times;
};
Request requests[most];
int known = 0;
std::atomic<bool> counting { false };
std::atomic_flag busy = ATOMIC_FLAG_INIT;
thread_local bool noting = false; // backtrace itself may ask for memory

void note()
{
	if (!counting || noting)
		return;
	noting = true;
	void* callers[depth];
	const int count = backtrace(callers, depth);
	while (busy.test_and_set()) { }
	int k = 0;
	while (k < known && (requests[k].count != count || std::memcmp(requests[k].callers, callers, count * sizeof *callers) != 0))
		k++;
	if (k < most) {
		std::memcpy(requests[k].callers, callers, count * sizeof *callers);
		requests[k].count = count;
		requests[k].times = k < known ? requests[k].times + 1 : 1;
		known = k < known ? known : k + 1;
	}
	busy.clear();
	noting = false;
}

std::atomic<long> left { 0 }; // requests of the plug-in up to the one that is refused; 0: none is

bool refused()
{
	if (left <= 0 || noting)
		return false;
	noting = true;
	void* callers[4];
	const int count = backtrace(callers, 4);
	bool ours = false;
	for (int i = 0; i < count; i++) {
		Dl_info info {};
		ours = ours || (dladdr(callers[i], &info) && info.dli_fname && std::strstr(info.dli_fname, "_yade_plugin.so"));
	}
	noting = false;
	return ours && --left == 0;
}

} // namespace

extern "C" {

void* malloc(size_t size)
{
	if (refused())
		return nullptr;
	note();
	return __libc_malloc(size);
}

void* calloc(size_t count, size_t size)
{
	note();
	return __libc_calloc(count, size);
}

void* realloc(void* memory, size_t size)
{
	note();
	return __libc_realloc(memory, size);
}

void* aligned_alloc(size_t alignment, size_t size)
{
	note();
	return __libc_memalign(alignment, size);
}

int posix_memalign(void** memory, size_t alignment, size_t size)
{
	note();
	*memory = __libc_memalign(alignment, size);
	return *memory ? 0 : ENOMEM;
}

void countStart()
{
	void* first[1];
	backtrace(first, 1); // loads what it needs, once
	counting = true;
}

// A request that has to be counted.
void askForMemory()
{
	void* volatile some = std::malloc(100000);
	std::free(some);
}

void countStop() { counting = false; }

// Refuses the request of the plug-in of this number from now on; returns how many were left of the last call.
long refuse(long number)
{
	void* first[1];
	backtrace(first, 1);
	return left.exchange(number);
}

// A line for each way to a request: how often, then library:function from the request outwards.
void countPrint(const char* path)
{
	std::FILE* const out = std::fopen(path, "w");
	for (const Request* r = requests; r < requests + known; r++) {
		std::fprintf(out, "%ld", r->times);
		for (int i = 0; i < r->count; i++) {
			Dl_info info {};
			dladdr(r->callers[i], &info);
			const char* const name = info.dli_fname ? std::strrchr(info.dli_fname, '/') : nullptr;
			std::fprintf(out, " %s:%s", name ? name + 1 : "", info.dli_sname ? info.dli_sname : "");
		}
		std::fprintf(out, "\n");
	}
	std::fclose(out);
}
}
