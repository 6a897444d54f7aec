#include "allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> calls { 0 };

void* counted(std::size_t size, std::size_t alignment)
{
	calls++;
	// aligned_alloc asks for a whole number of alignments.
	void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
	if (!memory)
		throw std::bad_alloc();
	return memory;
}

} // namespace

std::size_t allocations() { return calls; }

void* operator new(std::size_t size) { return counted(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }
void* operator new(std::size_t size, std::align_val_t alignment) { return counted(size, static_cast<std::size_t>(alignment)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
