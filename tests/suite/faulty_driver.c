// A Vulkan driver that hands everything on to another one, but for one call: FAULT=FUNCTION:N:RESULT makes the N-th call of this
// function return RESULT, and FAULT=FUNCTION:N:drop makes it return 0 without a call. INNER names the other driver's library.

#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void (*Function)(void);
typedef Function (*Lookup)(void *, const char *);
// Integers and pointers travel alike: any function of up to eight of them.
typedef intptr_t (*Call)(intptr_t, intptr_t, intptr_t, intptr_t, intptr_t, intptr_t, intptr_t, intptr_t);

static void *inner;
static Lookup of_instance, of_physical_device, of_device;
static Call real;
static char name[64];
static long at, result, calls;

static void open_inner(void) {
    if (inner) return;
    inner = dlopen(getenv("INNER"), RTLD_NOW | RTLD_LOCAL);
    if (!inner) abort();
    of_instance = (Lookup)dlsym(inner, "vk_icdGetInstanceProcAddr");
    of_physical_device = (Lookup)dlsym(inner, "vk_icdGetPhysicalDeviceProcAddr");
    const char *fault = getenv("FAULT");
    const char *number = fault ? strchr(fault, ':') : 0;
    const char *code = number ? strchr(number + 1, ':') : 0;
    if (!code || (size_t)(number - fault) >= sizeof name) return;
    memcpy(name, fault, number - fault);
    at = atol(number + 1);
    // "drop" is no number, and so 0.
    result = atol(code + 1);
}

static intptr_t faulty(intptr_t a, intptr_t b, intptr_t c, intptr_t d, intptr_t e, intptr_t f, intptr_t g, intptr_t h) {
    return __sync_add_and_fetch(&calls, 1) == at ? result : real(a, b, c, d, e, f, g, h);
}

static Function hooked(const char *asked, Function function) {
    if (!function || strcmp(asked, name)) return function;
    real = (Call)function;
    return (Function)faulty;
}

static Function device_lookup(void *device, const char *asked) {
    return hooked(asked, of_device(device, asked));
}

Function vk_icdGetInstanceProcAddr(void *instance, const char *asked) {
    open_inner();
    Function function = of_instance(instance, asked);
    if (function && !strcmp(asked, "vkGetDeviceProcAddr")) {
        of_device = (Lookup)function;
        return (Function)device_lookup;
    }
    return hooked(asked, function);
}

Function vk_icdGetPhysicalDeviceProcAddr(void *instance, const char *asked) {
    open_inner();
    return of_physical_device ? hooked(asked, of_physical_device(instance, asked)) : 0;
}

int vk_icdNegotiateLoaderICDInterfaceVersion(uint32_t *version) {
    open_inner();
    return ((int (*)(uint32_t *))dlsym(inner, "vk_icdNegotiateLoaderICDInterfaceVersion"))(version);
}
