// What this pipeline simulates. The host sets every constant from the scene's effects; src/gpu/kernel/specialisation.rs is the only place
// that does. The defaults compile everything.

override AMBIENT: bool = true;
override DIFFUSE: bool = true;
override SPECULAR: bool = true;
override SHADOWS: bool = true;
override REFLECTIONS: bool = true;
// Primary rays test the image plane and see inner walls.
override SHELLS: bool = true;
// Object space differs from world space by more than a translation.
override ELLIPSOIDS: bool = true;

// The specular term is (N.H)^n instead of (R.V)^n.
override BLINN: bool = false;

// Pixels say where rounding could decide whether a primary ray touches a sphere.
override TANGENTS: bool = false;

// Pixels say where rounding could decide anything that they show.
override CERTIFIED: bool = false;

// Samples of each pixel, and columns of them: the side of a grid, or as many as there are samples.
override SAMPLES: u32 = 1u;
override SIDE: u32 = 1u;

// Primary rays begin on the window, and all have the same direction, instead of coming from the eye.
override PARALLEL: bool = false;

// Each pixel also says its colour before that is quantised, and how many of its samples hit something.
override LINEAR: bool = false;

// Each pixel also says how many rays it took.
override COUNT_RAYS: bool = false;

// Or how many tests of a ray with a sphere.
override COUNT_TESTS: bool = false;

// Each pixel shows what one mirrored or refracted ray adds to its colour, and nothing else.
override ONE_RAY: bool = false;

// Invocations of a workgroup of the kernels that are not over tiles.
override GROUP: u32 = 64u;
