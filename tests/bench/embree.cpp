// What one would write on Intel Embree 3 for scenes of spheres: a peer of trueray for benchmarks, not a part of it.
//
//     c++ -O3 -march=native -std=c++17 tests/bench/embree.cpp -lembree3 -lpthread -o embree
//     ./embree SCENE OUTPUT.ppm [THREADS] [--geometry user|sphere] [--res WxH] [--depth N]
//
// The picture is that of `trueray render --convention classic --precision fast` but for pixels on edges, more of them where
// mirrors magnify rounding. Rays go in packets of 16 with AVX-512, of 8 without. `user` (the default) is a user geometry
// with vectorised intersection, `sphere` is Embree's own RTC_GEOMETRY_TYPE_SPHERE_POINT. One line goes to standard
// output: the times of building Embree's scene and of rendering into memory. Exit codes are trueray's:
// 2 wrong arguments, 3 scene, 4 Embree or memory, 6 output file.

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

// ---- Vectors of lanes, one lane a ray ---------------------------------------------------------------------------------

#if defined(__AVX512F__)
constexpr int LANES = 16;
using RayHit = RTCRayHit16;
using Ray = RTCRay16;
constexpr auto INTERSECT = rtcIntersect16;
constexpr auto OCCLUDED = rtcOccluded16;
constexpr auto NATIVE_PACKETS = RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED;
#elif defined(__AVX__)
constexpr int LANES = 8;
using RayHit = RTCRayHit8;
using Ray = RTCRay8;
constexpr auto INTERSECT = rtcIntersect8;
constexpr auto OCCLUDED = rtcOccluded8;
constexpr auto NATIVE_PACKETS = RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED;
#else
#error "needs AVX at least: compile with -march=native"
#endif

typedef float Floats __attribute__((vector_size(4 * LANES)));
typedef int32_t Ints __attribute__((vector_size(4 * LANES)));  // masks, too: 0 and -1, from comparisons and for Embree

template <class F>  // Floats, or float where rays go one by one
struct Vec3 {
    F x, y, z;
};
using Vec = Vec3<Floats>;

static inline Floats splat(float x) { return x - Floats{}; }
static inline Vec splat(const float* v) { return {splat(v[0]), splat(v[1]), splat(v[2])}; }
static inline Floats load(const float* from) { Floats v; std::memcpy(&v, from, sizeof v); return v; }
static inline Ints load(const int* from) { Ints v; std::memcpy(&v, from, sizeof v); return v; }
static inline Ints load(const unsigned* from) { Ints v; std::memcpy(&v, from, sizeof v); return v; }
static inline void store(float* to, Floats v) { std::memcpy(to, &v, sizeof v); }
static inline void store(int* to, Ints v) { std::memcpy(to, &v, sizeof v); }
static inline void store(unsigned* to, Ints v) { std::memcpy(to, &v, sizeof v); }
template <class F> static inline Vec3<F> operator+(Vec3<F> a, Vec3<F> b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
template <class F> static inline Vec3<F> operator-(Vec3<F> a, Vec3<F> b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
template <class F> static inline Vec3<F> operator*(Vec3<F> a, Vec3<F> b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
template <class F> static inline Vec3<F> operator*(Vec3<F> a, F b) { return {a.x * b, a.y * b, a.z * b}; }
template <class F> static inline F dot(Vec3<F> a, Vec3<F> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec select(Ints mask, Vec a, Vec b) { return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z}; }

// What operators on vectors cannot say: square roots, masks as bits, and `lanes` of a vector side by side at `to`.
#if defined(__AVX512F__)
static inline Floats root(Floats x) { return (Floats)_mm512_maskz_sqrt_ps(0xffff, (__m512)x); }
static inline unsigned bits(Ints mask) { return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask); }
static inline void pack(void* to, Floats v, unsigned lanes) {
    _mm512_storeu_ps(to, _mm512_maskz_compress_ps(__mmask16(lanes), (__m512)v));
}
#else
static inline Floats root(Floats x) { return (Floats)_mm256_sqrt_ps((__m256)x); }
static inline unsigned bits(Ints mask) { return unsigned(_mm256_movemask_ps((__m256)mask)); }
static inline void pack(void* to, Floats v, unsigned lanes) {
    for (char* next = static_cast<char*>(to); lanes; lanes &= lanes - 1, next += sizeof(float))
        std::memcpy(next, reinterpret_cast<const char*>(&v) + sizeof(float) * unsigned(__builtin_ctz(lanes)), sizeof(float));
}
#endif

// x to the power of n for 0 < x <= 2 and n >= 0: exp(n log x), with the polynomials of Cephes' logf and expf.
static inline Floats power(Floats x, Floats n) {
    // x = 2^exponent (1 + m) with 1 + m in [sqrt(1/2), sqrt(2)), so that nothing cancels near 1, where highlights are.
    const Ints exponent = ((Ints)x - 0x3f3504f3) >> 23;
    const Floats m = (Floats)((Ints)x - (exponent << 23)) - 1.0f;
    Floats p = 7.0376836292e-2f * m - 1.1514610310e-1f;
    for (const float c : {1.1676998740e-1f, -1.2420140846e-1f, 1.4249322787e-1f, -1.6668057665e-1f, 2.0000714765e-1f,
                          -2.4999993993e-1f, 3.3333331174e-1f, -0.5f, 1.0f})
        p = p * m + c;
    Floats y = n * (p * m + __builtin_convertvector(exponent, Floats) * 0.693147181f);
    y = y > -87.0f ? y : splat(-87.0f);  // e^-87 is as good as 0
    y = y < 88.0f ? y : splat(88.0f);
    // e^y = 2^k e^r with |r| <= ln(2) / 2; adding 1.5 * 2^23 rounds to k and leaves its bits at the end.
    const Floats shifted = y * 1.44269504f + 12582912.0f, k = shifted - 12582912.0f;
    const Floats r = y - k * 0.693359375f + k * 2.12194440e-4f;
    Floats e = 1.9875691500e-4f * r + 1.3981999507e-3f;
    for (const float c : {8.3334519073e-3f, 4.1665795894e-2f, 1.6666665459e-1f, 5.0000001201e-1f, 1.0f, 1.0f}) e = e * r + c;
    return (Floats)((Ints)e + ((Ints)shifted << 23));
}

// ---- The scene and its file -------------------------------------------------------------------------------------------

struct Sphere { float x, y, z, radius; };
struct Surface { float x, y, z, radius, red, green, blue, ka, kd, ks, kr, n; };
struct Light { float position[3], intensity[3]; };
struct Failure { int code; std::string message; };

// A tile is one unit of work, and its rays stay in cache; pictures are kept in whole tiles, and what sticks out is rendered.
constexpr int TILE = 24, TILE_PIXELS = TILE * TILE, PACKET_WIDTH = 4, PACKET_HEIGHT = LANES / PACKET_WIDTH;

struct Scene {
    int width, height, stride, rows;  // stride and rows in whole tiles
    float near, ambient[3] = {}, background[3] = {};
    std::vector<float> x, y;  // of the samples on the image plane, LANES for each column and each row of packets
    std::vector<Sphere> spheres;    // what intersection reads
    std::vector<Surface> surfaces;  // what shading reads
    std::vector<Light> lights;
};

static std::vector<std::string> tokens_of(const std::string& line) {
    std::vector<std::string> tokens;
    const std::string text = line.substr(0, line.find('#'));
    for (size_t end = 0, start; (start = text.find_first_not_of(" \t\r", end)) != std::string::npos;) {
        end = std::min(text.find_first_of(" \t\r", start), text.size());
        tokens.push_back(text.substr(start, end - start));
    }
    return tokens;
}

static Scene read_scene(const std::string& path, int width, int height) {
    // How many numbers follow each keyword and its name, where it has one.
    const std::map<std::string, size_t> statements = {{"NEAR", 1}, {"LEFT", 1}, {"RIGHT", 1},   {"BOTTOM", 1},  {"TOP", 1},
                                                      {"RES", 2},  {"BACK", 3}, {"AMBIENT", 3}, {"SPHERE", 14}, {"LIGHT", 6},
                                                      {"OUTPUT", 0}};
    size_t line_number = 0;
    const auto check = [&](bool fine, const std::string& problem) {
        if (!fine) throw Failure{3, path + ":" + std::to_string(line_number) + ": " + problem};
    };
    std::ifstream file(path);
    check(bool(file), "cannot be read");
    Scene scene;
    std::map<std::string, std::vector<double>> once;
    std::vector<double> v;
    const auto f = [&](size_t i) { return float(v[i]); };
    for (std::string line; std::getline(file, line);) {
        ++line_number;
        const std::vector<std::string> tokens = tokens_of(line);
        if (tokens.empty()) continue;
        const std::string& keyword = tokens[0];
        const auto statement = statements.find(keyword);
        check(statement != statements.end(), "unknown statement " + keyword);
        const bool named = keyword == "SPHERE" || keyword == "LIGHT" || keyword == "OUTPUT";
        v.clear();
        for (size_t i = named ? 2 : 1; i < tokens.size(); ++i) {
            char* end;
            v.push_back(std::strtod(tokens[i].c_str(), &end));
            check(!*end && std::isfinite(float(v.back())), tokens[i] + " is not a number in range");
        }
        check(keyword != "SPHERE" || v.size() != 16, "refraction is not supported");
        check(v.size() == statement->second && (!named || tokens.size() > 1), "wrong number of fields for " + keyword);
        if (keyword == "SPHERE") {
            const float r = std::fabs(f(3));
            check(r == std::fabs(f(4)) && r == std::fabs(f(5)), "ellipsoids are not supported");
            check(r > 0 && f(13) >= 0, "a sphere needs a radius and an exponent from 0");
            scene.spheres.push_back({f(0), f(1), f(2), r});
            scene.surfaces.push_back({f(0), f(1), f(2), r, f(6), f(7), f(8), f(9), f(10), f(11), f(12), f(13)});
        } else if (keyword == "LIGHT") {
            scene.lights.push_back({{f(0), f(1), f(2)}, {f(3), f(4), f(5)}});
        } else {
            check(once.emplace(keyword, v).second, "a second " + keyword);
        }
    }
    check(file.eof(), "cannot be read");
    for (const char* needed : {"NEAR", "LEFT", "RIGHT", "BOTTOM", "TOP", "RES"})
        check(once.count(needed), std::string("there is no ") + needed);
    const double left = once["LEFT"][0], right = once["RIGHT"][0], bottom = once["BOTTOM"][0], top = once["TOP"][0];
    scene.near = float(once["NEAR"][0]);
    check(scene.near > 0 && left != right && bottom != top, "the window is empty, or not in front of the eye");
    const double w = width ? width : once["RES"][0], h = height ? height : once["RES"][1];
    check(w == std::floor(w) && h == std::floor(h) && w >= 1 && h >= 1 && w <= 1 << 20 && h <= 1 << 20 && w * h <= 1 << 28,
          "RES takes whole numbers from 1 and not too large ones");
    scene.width = int(w), scene.height = int(h);
    scene.stride = (scene.width + TILE - 1) / TILE * TILE;
    scene.rows = (scene.height + TILE - 1) / TILE * TILE;
    for (int i = 0; i < scene.stride; i += PACKET_WIDTH)
        for (int lane = 0; lane < LANES; ++lane)
            scene.x.push_back(float(left + (right - left) * (i + lane % PACKET_WIDTH) / w));
    for (int j = 0; j < scene.rows; j += PACKET_HEIGHT)
        for (int lane = 0; lane < LANES; ++lane)
            scene.y.push_back(float(top - (top - bottom) * (j + lane / PACKET_WIDTH) / h));
    for (size_t c = 0; c < 3; ++c) {
        if (once.count("AMBIENT")) scene.ambient[c] = float(once["AMBIENT"][c]);
        if (once.count("BACK")) scene.background[c] = float(once["BACK"][c]);
    }
    return scene;
}

// ---- Spheres for Embree -----------------------------------------------------------------------------------------------

// Where rays come closest to a centre; they have unit length, which saves a division. The discriminant is taken from that
// distance: in b*b - 4ac it would cancel.
template <class F>
struct Approach {
    F along;              // the way there
    Vec3<F> from_centre;  // the place
    F discriminant;
};

template <class F>
static inline Approach<F> approach(Vec3<F> origin, Vec3<F> direction, Vec3<F> centre, F radius) {
    const Vec3<F> from_centre = origin - centre;
    const F along = -dot(from_centre, direction);
    const Vec3<F> closest = from_centre + direction * along;
    return {along, closest, radius * radius - dot(closest, closest)};
}

static inline Approach<Floats> approach(const Ray& ray, const Sphere& s) {
    const Vec origin = {load(ray.org_x), load(ray.org_y), load(ray.org_z)};
    const Vec direction = {load(ray.dir_x), load(ray.dir_y), load(ray.dir_z)};
    return approach(origin, direction, {splat(s.x), splat(s.y), splat(s.z)}, splat(s.radius));
}

template <class Arguments>
static inline const Sphere& sphere_of(const Arguments* args) {
    return static_cast<const Sphere*>(args->geometryUserPtr)[args->primID];
}

static void bound(const RTCBoundsFunctionArguments* args) {
    const Sphere& s = sphere_of(args);
    *args->bounds_o = {s.x - s.radius, s.y - s.radius, s.z - s.radius, 0, s.x + s.radius, s.y + s.radius, s.z + s.radius, 0};
}

static void intersect_one(const RTCIntersectFunctionNArguments* args) {
    auto& [ray, hit] = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const Sphere& s = sphere_of(args);
    const Vec3<float> origin = {ray.org_x, ray.org_y, ray.org_z}, direction = {ray.dir_x, ray.dir_y, ray.dir_z};
    const auto at = approach(origin, direction, {s.x, s.y, s.z}, s.radius);
    if (!(at.discriminant >= 0.0f)) return;
    const float half_chord = std::sqrt(at.discriminant);
    const float t = at.along - half_chord > ray.tnear ? at.along - half_chord : at.along + half_chord;
    if (t > ray.tnear && t < ray.tfar) ray.tfar = t, hit.primID = args->primID, hit.geomID = args->geomID;
}

// Embree hands over packets as they came, so that N is 1 or LANES.
static void intersect(const RTCIntersectFunctionNArguments* args) {
    if (args->N == 1) return intersect_one(args);
    auto& [ray, hit] = *reinterpret_cast<RayHit*>(args->rayhit);
    const auto at = approach(ray, sphere_of(args));
    const Ints met = load(args->valid) & (at.discriminant >= 0.0f);
    if (!bits(met)) return;
    const Floats tnear = load(ray.tnear), tfar = load(ray.tfar), half_chord = root(at.discriminant);
    const Floats t = at.along - half_chord > tnear ? at.along - half_chord : at.along + half_chord;
    const Ints nearer = met & (t > tnear) & (t < tfar);
    store(ray.tfar, nearer ? t : tfar);
    store(hit.primID, nearer ? int(args->primID) - Ints{} : load(hit.primID));
    store(hit.geomID, nearer ? int(args->geomID) - Ints{} : load(hit.geomID));
}

// Either root between tnear and tfar, without a square root: x |x| rises with x, so it is compared in place of x.
static void occlude(const RTCOccludedFunctionNArguments* args) {
    Ray& ray = *reinterpret_cast<Ray*>(args->ray);
    const auto at = approach(ray, sphere_of(args));
    const Floats tfar = load(ray.tfar), from = load(ray.tnear) - at.along, to = tfar - at.along, d = at.discriminant;
    const Floats low = from * (from < 0.0f ? -from : from), high = to * (to < 0.0f ? -to : to);
    const Ints blocked = load(args->valid) & (d >= 0.0f) & (((-d > low) & (-d < high)) | ((d > low) & (d < high)));
    store(ray.tfar, blocked ? splat(-std::numeric_limits<float>::infinity()) : tfar);
}

static RTCScene build(RTCDevice device, Scene& scene, bool user_geometry) {
    const RTCScene built = rtcNewScene(device);
    if (!scene.spheres.empty()) {
        const auto type = user_geometry ? RTC_GEOMETRY_TYPE_USER : RTC_GEOMETRY_TYPE_SPHERE_POINT;
        const RTCGeometry geometry = rtcNewGeometry(device, type);
        if (user_geometry) {
            rtcSetGeometryUserPrimitiveCount(geometry, unsigned(scene.spheres.size()));
            rtcSetGeometryUserData(geometry, scene.spheres.data());
            rtcSetGeometryBoundsFunction(geometry, bound, nullptr);
            rtcSetGeometryIntersectFunction(geometry, intersect);
            rtcSetGeometryOccludedFunction(geometry, occlude);
        } else {
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, scene.spheres.data(), 0,
                                       sizeof(Sphere), scene.spheres.size());
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(built, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(built);  // on the device's threads
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw Failure{4, "Embree cannot build the scene"};
    return built;
}

// ---- Rendering --------------------------------------------------------------------------------------------------------

// The mirrored rays of a tile, side by side: in place, packets of them would be mostly empty.
struct Mirrored {
    int count = 0;
    int pixel[TILE_PIXELS + LANES] = {};
    float fields[7][TILE_PIXELS + LANES] = {};  // origin, direction, weight of the colour in its pixel

    void push(unsigned lanes, Ints pixels, Vec origin, Vec direction, Floats weight) {
        pack(pixel + count, (Floats)pixels, lanes);
        const Floats values[7] = {origin.x, origin.y, origin.z, direction.x, direction.y, direction.z, weight};
        for (int i = 0; i < 7; ++i) pack(fields[i] + count, values[i], lanes);
        count += __builtin_popcount(lanes);
    }

    Vec vec(int field, int first) const {
        return {load(fields[field] + first), load(fields[field + 1] + first), load(fields[field + 2] + first)};
    }
};

// One thread's work on one tile after another. The pixels of a tile are in the order of its packets.
class Painter {
  public:
    Painter(const Scene& scene, RTCScene built, int depth, bool user_geometry, uint32_t* picture)
        : scene(scene), built(built), depth(depth), picture(picture) {
        for (int lane = 0; lane < LANES; ++lane) {
            lane_numbers[lane] = lane;
            packet.ray.mask[lane] = shadow_packet.mask[lane] = ~0u;
        }
        rtcInitIntersectContext(&plain);
        rtcInitIntersectContext(&coherent);
        // Measured. While trees are flat, traversal of a packet as one frustum costs more than it saves; when they are deep,
        // packets of mirrored rays fall apart. With Embree's own spheres those are no faster one by one.
        const bool many = scene.spheres.size() > 5000;
        if (many) coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        one_by_one = many && user_geometry;
    }

    void paint(int tile) {
        const int left = tile % (scene.stride / TILE) * TILE, top = tile / (scene.stride / TILE) * TILE;
        Mirrored *now = &lists[0], *next = &lists[1];
        next->count = 0;
        int first = 0;
        for (int j = top; j < top + TILE; j += PACKET_HEIGHT)
            for (int i = left; i < left + TILE; i += PACKET_WIDTH, first += LANES) primary(i, j, first, *next);
        for (int bounce = 1; bounce <= depth && next->count > 0; ++bounce) {
            std::swap(now, next);
            next->count = 0;
            for (int ray = 0; ray < now->count; ray += LANES) mirrored(*now, ray, bounce, *next);
        }
        first = 0;
        for (int j = top; j < top + TILE; j += PACKET_HEIGHT)
            for (int i = left; i < left + TILE; i += PACKET_WIDTH, first += LANES) {
                const Ints pixels = level(red + first) | level(green + first) << 8 | level(blue + first) << 16;
                for (int y = 0; y < PACKET_HEIGHT; ++y)
                    std::memcpy(picture + size_t(j + y) * size_t(scene.stride) + size_t(i),
                                reinterpret_cast<const int*>(&pixels) + y * PACKET_WIDTH, PACKET_WIDTH * sizeof *picture);
            }
    }

  private:
    static Ints level(const float* colour) {
        const Floats c = load(colour) * 255.0f;
        const Floats above = c > 0.0f ? c : splat(0.0f);  // also where c is NaN
        return __builtin_convertvector(above < 255.0f ? above : splat(255.0f), Ints);
    }

    static void aim(Ray& ray, Vec origin, Vec direction, Floats tnear, Floats tfar) {
        store(ray.org_x, origin.x), store(ray.org_y, origin.y), store(ray.org_z, origin.z);
        store(ray.dir_x, direction.x), store(ray.dir_y, direction.y), store(ray.dir_z, direction.z);
        store(ray.tnear, tnear), store(ray.tfar, tfar);
    }

    // Which of the valid lanes meet a sphere: what and where is left in `packet`.
    Ints trace(Vec origin, Vec direction, Floats tnear, Ints valid, bool is_primary) {
        aim(packet.ray, origin, direction, tnear, splat(std::numeric_limits<float>::infinity()));
        store(packet.hit.geomID, ~Ints{});
        if (is_primary || !one_by_one)
            INTERSECT(reinterpret_cast<const int*>(&valid), built, is_primary ? &coherent : &plain, &packet);
        else
            for (unsigned lanes = bits(valid); lanes; lanes &= lanes - 1) trace_one(__builtin_ctz(lanes));
        return valid & (load(packet.hit.geomID) != -1);
    }

    void trace_one(int lane) {
        auto& [from, hit] = packet;
        RTCRayHit one = {};
        one.ray.org_x = from.org_x[lane], one.ray.org_y = from.org_y[lane], one.ray.org_z = from.org_z[lane];
        one.ray.dir_x = from.dir_x[lane], one.ray.dir_y = from.dir_y[lane], one.ray.dir_z = from.dir_z[lane];
        one.ray.tnear = from.tnear[lane], one.ray.tfar = from.tfar[lane], one.ray.mask = ~0u;
        one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(built, &plain, &one);
        from.tfar[lane] = one.ray.tfar, hit.primID[lane] = one.hit.primID, hit.geomID[lane] = one.hit.geomID;
    }

    // In which of the valid lanes a sphere stands before the light, but not within the first 0.001 of the way.
    Ints shadowed(Vec position, Vec to_light, Floats distance, Ints valid) {
        aim(shadow_packet, position, to_light, distance * 1e-3f, distance);
        OCCLUDED(reinterpret_cast<const int*>(&valid), built, &coherent, &shadow_packet);
        return load(shadow_packet.tfar) < 0.0f;
    }

    void primary(int i, int j, int first, Mirrored& next) {
        const Vec eye = {splat(0.0f), splat(0.0f), splat(0.0f)};
        const Vec to_plane = {load(&scene.x[size_t(i / PACKET_WIDTH * LANES)]),
                              load(&scene.y[size_t(j / PACKET_HEIGHT * LANES)]), splat(-scene.near)};
        const Floats length = root(dot(to_plane, to_plane));
        const Vec direction = to_plane * (1.0f / length);
        // What lies between the eye and the image plane, or touches it, is cut away.
        const Ints hit = trace(eye, direction, length * (1.0f + 1e-6f), ~Ints{}, true);
        Vec colour = splat(scene.background);
        const Ints pixels = load(lane_numbers) + first;
        if (bits(hit)) colour = select(hit, shade(eye, direction, splat(1.0f), pixels, hit, depth > 0, next), colour);
        store(red + first, colour.x), store(green + first, colour.y), store(blue + first, colour.z);
    }

    void mirrored(const Mirrored& now, int first, int bounce, Mirrored& next) {
        const Vec origin = now.vec(0, first), direction = now.vec(3, first);
        const Ints hit = trace(origin, direction, splat(1e-3f), load(lane_numbers) < now.count - first, false);
        if (!bits(hit)) return;  // black
        const Floats weight = load(now.fields[6] + first);
        const Vec colour = shade(origin, direction, weight, load(now.pixel + first), hit, bounce < depth, next) * weight;
        for (unsigned lanes = bits(hit); lanes; lanes &= lanes - 1) {
            const int lane = __builtin_ctz(lanes), pixel = now.pixel[first + lane];
            red[pixel] += colour.x[lane], green[pixel] += colour.y[lane], blue[pixel] += colour.z[lane];
        }
    }

    // What a Surface says of the spheres that the lanes met, field by field.
    struct Surfaces { Floats x, y, z, radius, red, green, blue, ka, kd, ks, kr, n; };

    Surfaces surfaces(Ints hit) const {
        constexpr int FIELDS = sizeof(Surface) / sizeof(float);
        const unsigned *ids = packet.hit.primID, some = ids[__builtin_ctz(bits(hit))];
        Floats fields[FIELDS];
        const float* of_some = &scene.surfaces[some].x;
        for (int i = 0; i < FIELDS; ++i) fields[i] = splat(of_some[i]);
        if (bits(hit & (load(ids) != int(some)))) {  // rarely so where spheres are large
            for (unsigned lanes = bits(hit); lanes; lanes &= lanes - 1) {
                const int lane = __builtin_ctz(lanes);
                const float* of_lane = &scene.surfaces[ids[lane]].x;
                for (int i = 0; i < FIELDS; ++i) fields[i][lane] = of_lane[i];
            }
        }
        Surfaces result;
        std::memcpy(&result, fields, sizeof result);
        return result;
    }

    // The light that the hits send back along their rays, but for what they mirror: those rays are added to `next`.
    Vec shade(Vec origin, Vec direction, Floats weight, Ints pixels, Ints hit, bool mirror, Mirrored& next) {
        const Surfaces s = surfaces(hit);
        const Vec centre = {s.x, s.y, s.z}, own_colour = {s.red, s.green, s.blue};
        const auto at = approach(origin, direction, centre, s.radius);
        // Half a chord back or forth from the closest approach: origin + t direction would lose what distance costs.
        const Ints inside = load(packet.ray.tfar) > at.along;
        const Floats half_chord = root(at.discriminant > 0.0f ? at.discriminant : splat(0.0f));
        const Vec outward = at.from_centre + direction * (inside ? half_chord : -half_chord);
        const Vec position = centre + outward;
        const Floats to_unit = 1.0f / root(dot(outward, outward));
        const Vec normal = outward * (inside ? -to_unit : to_unit);
        const Floats n_dot_d = dot(normal, direction);

        Vec colour = splat(scene.ambient) * own_colour * s.ka;
        for (const Light& light : scene.lights) {
            const Vec way = splat(light.position) - position;
            const Floats distance = root(dot(way, way));
            const Vec to_light = way * (1.0f / distance);
            const Floats n_dot_l = dot(normal, to_light);
            Ints lit = hit & (n_dot_l > 0.0f);  // not by a light at distance 0, where it is NaN
            if (bits(lit)) lit &= ~shadowed(position, to_light, distance, lit);
            if (!bits(lit)) continue;
            // R.V with R = 2 (N.L) N - L and V the ray backwards.
            const Floats r_dot_v = dot(to_light, direction) - 2.0f * n_dot_l * n_dot_d;
            const Floats highlight = power(r_dot_v > 0.0f ? r_dot_v : splat(1.0f), s.n);
            const Floats shine = s.ks * ((r_dot_v > 0.0f) | (s.n == 0.0f) ? highlight : splat(0.0f));
            const Floats diffuse = s.kd * n_dot_l;
            const Vec sent = own_colour * diffuse + Vec{shine, shine, shine};
            colour = select(lit, colour + splat(light.intensity) * sent, colour);
        }
        const unsigned mirrors = mirror ? bits(hit & (s.kr != 0.0f)) : 0;
        if (mirrors) next.push(mirrors, pixels, position, direction - normal * (2.0f * n_dot_d), weight * s.kr);
        return colour;
    }

    const Scene& scene;
    const RTCScene built;
    const int depth;
    uint32_t* const picture;
    int lane_numbers[LANES];
    RTCIntersectContext plain, coherent;
    bool one_by_one;
    RayHit packet = {};
    Ray shadow_packet = {};
    float red[TILE_PIXELS], green[TILE_PIXELS], blue[TILE_PIXELS];
    Mirrored lists[2];
};

static void render(const Scene& scene, RTCScene built, int depth, bool user_geometry, int threads, uint32_t* picture) {
    const int tiles = scene.stride / TILE * (scene.rows / TILE);
    std::atomic<int> next_tile{0};
    const auto work = [&] {
        _mm_setcsr(_mm_getcsr() | 0x8040);  // numbers near 0 count as 0: Embree asks it of every thread that traces
        const auto painter = std::make_unique<Painter>(scene, built, depth, user_geometry, picture);
        for (int tile; (tile = next_tile++) < tiles;) painter->paint(tile);
    };
    std::vector<std::thread> others;
    for (int i = 1; i < threads; ++i) others.emplace_back(work);
    work();
    for (std::thread& thread : others) thread.join();
}

// ---- The command ------------------------------------------------------------------------------------------------------

static void write_picture(const std::string& path, const Scene& scene, const uint32_t* picture) {
    std::string bytes = "P6\n" + std::to_string(scene.width) + " " + std::to_string(scene.height) + "\n255\n";
    for (int j = 0; j < scene.height; ++j)
        for (int i = 0; i < scene.width; ++i)
            for (const int shift : {0, 8, 16})
                bytes.push_back(char(picture[size_t(j) * size_t(scene.stride) + size_t(i)] >> shift));
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), std::streamsize(bytes.size()));
    file.close();
    if (!file) throw Failure{6, path + ": cannot be written"};
}

static int whole_number(const std::string& text, int least, int greatest) {
    char* end;
    const long number = std::strtol(text.c_str(), &end, 10);
    if (text.empty() || *end || number < least || number > greatest)
        throw Failure{2, "'" + text + "' is no number in range"};
    return int(number);
}

static void run(const std::vector<std::string>& arguments) {
    if (arguments == std::vector<std::string>{"--version"}) {
        std::printf("Embree %s\n", RTC_VERSION_STRING);
        return;
    }
    std::vector<std::string> files;
    std::map<std::string, std::string> options = {{"--geometry", "user"}, {"--res", "0x0"}, {"--depth", "3"}};
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& argument = arguments[i];
        if (argument.rfind("--", 0) != 0) files.push_back(argument);
        else if (options.count(argument) && i + 1 < arguments.size()) options[argument] = arguments[++i];
        else throw Failure{2, argument + ": unknown, or without a value"};
    }
    const bool user_geometry = options["--geometry"] == "user";
    if (files.size() < 2 || files.size() > 3 || (!user_geometry && options["--geometry"] != "sphere"))
        throw Failure{2, "usage: embree SCENE OUTPUT.ppm [THREADS] [--geometry user|sphere] [--res WxH] [--depth N]"};
    const std::string& res = options["--res"];
    const size_t by = std::min(res.find('x'), res.size() - !res.empty());
    // 0 is the scene's own.
    const int width = whole_number(res.substr(0, by), 0, 1 << 20), height = whole_number(res.substr(by + 1), 0, 1 << 20);
    const int depth = whole_number(options["--depth"], 0, 1000);
    const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
    const int threads = files.size() > 2 ? whole_number(files[2], 1, 256) : cores;

    Scene scene = read_scene(files[0], width, height);
    std::vector<uint32_t> picture(size_t(scene.stride) * size_t(scene.rows));
    const RTCDevice device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
    if (!device || !rtcGetDeviceProperty(device, NATIVE_PACKETS)) throw Failure{4, "no Embree with packets of this width"};

    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    const RTCScene built = build(device, scene, user_geometry);
    const auto ready = Clock::now();
    render(scene, built, depth, user_geometry, threads, picture.data());
    const auto done = Clock::now();
    write_picture(files[1], scene, picture.data());
    const auto ms = [](Clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); };
    std::printf("prepare %.3f ms, trace %.3f ms\n", ms(ready - start), ms(done - ready));
    rtcReleaseScene(built);
    rtcReleaseDevice(device);
}

int main(int count, char** arguments) {
    try {
        run({arguments + 1, arguments + count});
        return 0;
    } catch (const Failure& failure) {
        std::fprintf(stderr, "embree: %s\n", failure.message.c_str());
        return failure.code;
    } catch (const std::exception& error) {  // out of memory
        std::fprintf(stderr, "embree: %s\n", error.what());
        return 4;
    }
}
