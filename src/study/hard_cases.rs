//! The hard cases of `trueray stress` as accuracy against time: one panel a case.

use std::fmt::Write as _;

use maud::{Markup, html};
use serde::Serialize;

use crate::gpu::{DeviceInfo, Error, Gpu, Kernel};
use crate::precision::Tier;
use crate::report::Skipped;
use crate::report::number::short;
use crate::report::svg::{Axis, Frame, drawing, px, x_axis, y_axis};
use crate::stress::{Cost, Row, Verdict, classes, cost, run};

/// The classes of rays whose hits are counted right or wrong and whose error has a percentile.
const CLASSES: [u32; 9] = [1, 2, 3, 4, 5, 6, 7, 8, 11];

/// The kernels, in the order of tables and legend: each trap before the tier that it would be.
const KERNELS: [Kernel; 5] = [
    Kernel::Schoolbook,
    Kernel::Tier(Tier::Fast),
    Kernel::NoBarrier,
    Kernel::Tier(Tier::Robust),
    Kernel::Tier(Tier::Double),
];

/// For each ray of a case so many are timed: a dispatch should take long beside its submission.
const TIMED_RAYS: usize = 5;

/// Accuracy and time of the kernels on the hard cases.
#[derive(Debug, Clone, Serialize)]
pub struct HardCases {
    /// The device.
    pub device: DeviceInfo,
    /// Rays of each case.
    pub rays: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Time of a test on each kernel.
    pub costs: Vec<Cost>,
    /// Kernels that the device has not.
    pub skipped: Vec<Skipped>,
    /// Each case on each kernel.
    pub rows: Vec<Row>,
}

/// Runs the hard cases with so many `rays` each, and measures `runs` times what a test costs.
pub fn hard_cases(gpu: &Gpu, rays: usize, seed: u64, runs: usize) -> Result<HardCases, Error> {
    let mut classes = classes();
    classes.retain(|class| CLASSES.contains(&class.id));
    let mut rows = run(gpu, &KERNELS, &classes, rays, seed, |_| ())?;
    let mut skipped: Vec<Skipped> = Vec::new();
    for row in &rows {
        if let Verdict::Refused(why) = &row.verdict
            && !skipped.iter().any(|skipped| skipped.name == row.kernel)
        {
            skipped.push(Skipped { name: row.kernel.to_owned(), reason: why.clone() });
        }
    }
    rows.retain(|row| !matches!(row.verdict, Verdict::Refused(_)));
    let costs = cost(gpu, &KERNELS, rays * TIMED_RAYS, seed, runs)?;
    Ok(HardCases { device: gpu.device.info.clone(), rays, seed, costs, skipped, rows })
}

/// Whether `row` is of a kernel that no tier is: it promises nothing.
fn is_trap(row: &Row) -> bool {
    [Kernel::Schoolbook, Kernel::NoBarrier].iter().any(|kernel| kernel.name() == row.kernel)
}

/// Whether `row` is of a tier that does not cover the case, or shows too little of it.
fn is_unpromised(row: &Row) -> bool {
    !is_trap(row) && matches!(row.verdict, Verdict::NotCovered | Verdict::Reported | Verdict::TooFew(_))
}

fn wrong(row: &Row) -> f64 {
    row.metrics.per_million(row.metrics.wrong())
}

fn error(row: &Row) -> Option<f64> {
    row.metrics.p999.filter(|error| !error.is_nan())
}

/// Wrong rays in a million and the error, as tables show them.
fn words(row: &Row) -> [String; 2] {
    [short(wrong(row)), error(row).map_or_else(|| "–".to_owned(), short)]
}

/// The name of the case of `row`.
fn name(row: &Row) -> String {
    if row.case.is_empty() { row.class.to_owned() } else { format!("{}, {}", row.class, row.case) }
}

impl HardCases {
    /// The rows of each case.
    fn cases(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunk_by(|a, b| (a.id, a.case) == (b.id, b.case))
    }

    fn cost(&self, kernel: &str) -> Option<&Cost> {
        self.costs.iter().find(|cost| cost.kernel == kernel)
    }

    fn ns(&self, row: &Row) -> f64 {
        self.cost(row.kernel).map_or(f64::NAN, |cost| cost.ns.median())
    }

    /// The names of the kernels that were measured.
    fn kernels(&self) -> impl Iterator<Item = &'static str> {
        KERNELS.iter().map(|kernel| kernel.name()).filter(|name| self.cost(name).is_some())
    }

    /// The table for people.
    pub fn report(&self) -> String {
        let mut text = format!("Hard cases on {}, {} rays each, seed {}\n", self.device, self.rays, self.seed);
        for Skipped { name, reason } in &self.skipped {
            let _ = writeln!(text, "not measured: {name}: {reason}");
        }
        text += "wrong rays in a million, and 99.9th percentile of the relative error of t in units of 2⁻²³; (): not promised\n";
        let _ = write!(text, "{:30}", "");
        for kernel in self.kernels() {
            let _ = write!(text, " {kernel:>19}");
        }
        let _ = write!(text, "\n{:30}", "ns a test");
        for kernel in self.kernels() {
            let _ = write!(text, " {:>19}", self.cost(kernel).map_or_else(String::new, |cost| short(cost.ns.median())));
        }
        text.push('\n');
        for case in self.cases() {
            let _ = write!(text, "{:>2} {:27}", case[0].id, name(&case[0]));
            for kernel in self.kernels() {
                let row = case.iter().find(|row| row.kernel == kernel);
                let cell = row.map_or_else(String::new, |row| {
                    let [wrong, error] = words(row);
                    let (open, close) = if is_unpromised(row) { ("(", ")") } else { ("", " ") };
                    format!("{:>9} {error:>8}{close}", format!("{open}{wrong}"))
                });
                let _ = write!(text, " {cell:>19}");
            }
            text.push('\n');
        }
        text.lines().map(|line| line.trim_end().to_owned() + "\n").collect()
    }

    /// The section of the page.
    pub(super) fn section(&self) -> Markup {
        let scales = Scales::new(self);
        let broken: Vec<_> = self.rows.iter().filter(|row| !is_trap(row) && row.is_broken()).collect();
        let has = |kernel: Kernel| self.cost(kernel.name()).is_some();
        html! {
            h2 { "Hard cases" }
            p {
                "A scene can be kind to a kernel. These rays are not: grazing, from far away, from just above a surface. Each \
                 panel is one kind of ray on " (self.device.name) ", " (self.rays) " rays with seed " (self.seed) ". All \
                 panels have the same axes, so a kernel stands at the same place from left to right in each of them and \
                 only its height changes."
            }
            p {
                "Above: how many rays in a million are " b { "wrong" } ", a hit where there is none, a miss where there is a \
                 hit, or another root or sphere than the nearest; the shaded band is for none (heights within it mean nothing, they keep the marks apart). Below: the " b { "error" }
                " of the distance along the ray where it hits. Of a thousand hits, 999 are at least that good (the 99.9th percentile). \
                 Its unit u is 2⁻²³, the relative distance of neighbouring " code { "f32" } " numbers: 1 u is as much as can be \
                 asked of a result that is stored as one; what is better than 0.1 u lies on the lower edge. Truth is calculated in double-double arithmetic from the very numbers that \
                 the kernel got."
            }
            ul {
                li { b { "schoolbook" } " solves the quadratic as textbooks write it: the baseline that nobody should ship." }
                li { b { "fast, robust, double" } " are the tiers that render." }
                @if has(Kernel::NoBarrier) {
                    li {
                        b { "no-barrier" } " is robust without the barriers that keep a compiler from “simplifying” its \
                         error-free transforms. Where it falls back towards fast, this device's compiler did so; where it equals \
                         robust, this one happened not to, and nothing promises that the next will not."
                    }
                }
                @for Skipped { name, reason } in &self.skipped { li { "Not measured: " b { (name) } ": " (reason) } }
            }
            p.legend {
                @for kernel in self.kernels() {
                    span class=(class(kernel)) { (if kernel == "schoolbook" || kernel == "no-barrier" { "◆ " } else { "● " }) (kernel) }
                }
                span { "○ the tier does not promise this case" }
            }
            div.panels { @for case in self.cases() { (self.panel(case, &scales)) } }
            p.small {
                "A filled dot is a promise, not perfection: some promises allow a few wrong rays, or any so near to \
                 the tangent that rounding decides; many rays of “tangent” are so near."
                @if broken.is_empty() { " Every promise holds here." }
            }
            @for row in broken {
                @if let Verdict::Fail(why) = &row.verdict {
                    p { b { "Broken promise: " } (row.kernel) " on " (name(row)) ": " (why.join("; ")) }
                }
            }
            (self.table())
            p.small {
                "Each cell: wrong rays in a million, and the error in u. In brackets: not promised. Time of a test: median of wall-clock \
                 times of dispatches of " (self.rays * TIMED_RAYS) " rays against 32 spheres, the kernels in turn, submission \
                 included; on a device so fast that submission shows, more " code { "--hard-cases" } " time the kernels better."
            }
        }
    }

    fn panel(&self, case: &[Row], scales: &Scales) -> Markup {
        let first = &case[0];
        let about = classes().into_iter().find(|class| class.id == first.id).map_or("", |class| class.about);
        // Traps go below: where a tier does the same, its dot is seen on the trap's larger mark.
        let (traps, tiers): (Vec<&Row>, Vec<&Row>) = case.iter().partition(|row| is_trap(row));
        let ticks = scales.x.ticks();
        let mark = |row: &Row, height: f64| {
            let [wrong, error] = words(row);
            let tip =
                format!("{}: {} ns, {wrong} wrong in a million, error {error} u", row.kernel, short(self.ns(row)));
            mark(row, scales.x.place(self.ns(row)), height, &tip)
        };
        let content = html! {
            @for (x, _) in &ticks {
                line.grid x1=(px(*x)) x2=(px(*x)) y1=(px(UPPER.top)) y2=(px(BAND)) {}
            }
            rect.lane x=(px(UPPER.left)) y=(px(UPPER.bottom)) width=(px(UPPER.right - UPPER.left)) height=(px(BAND - UPPER.bottom)) {}
            text.tick x=(px(UPPER.left - 8.0)) y=(px(f64::midpoint(UPPER.bottom, BAND) + 4.0)) text-anchor="end" { "none" }
            (y_axis(&UPPER, &scales.wrong.ticks(), "wrong rays in a million"))
            (y_axis(&LOWER, &scales.error.ticks(), "error in u"))
            (x_axis(&LOWER, &ticks, "ns a test; left is faster"))
            @for row in traps.iter().chain(&tiers) {
                (mark(row, if wrong(row) > 0.0 { scales.wrong.place(wrong(row)) } else { lane(row) }))
                @if let Some(error) = error(row) { (mark(row, scales.error.place(error))) }
            }
        };
        html! {
            figure {
                p.head { b { (first.id) " " (name(first)) } br; span.small { (about) } }
                (drawing(300.0, LOWER.bottom + 46.0, &format!("Error against time: {}", name(first)), &content))
            }
        }
    }

    fn table(&self) -> Markup {
        let costs: [(&str, Read); 3] = [
            ("ns a test", |cost| short(cost.ns.median())),
            ("min … max", |cost| format!("{} … {}", short(cost.ns.min()), short(cost.ns.max()))),
            ("× schoolbook", |cost| short(cost.ratio)),
        ];
        html! {
            div.wide {
                table {
                    thead { tr { th { } @for kernel in self.kernels() { th colspan="2" class=(class(kernel)) { (kernel) } } } }
                    tbody {
                        @for (title, read) in costs {
                            tr {
                                td { (title) }
                                @for cost in self.kernels().filter_map(|kernel| self.cost(kernel)) { td colspan="2" { (read(cost)) } }
                            }
                        }
                        @for case in self.cases() {
                            tr {
                                td { (case[0].id) " " (name(&case[0])) }
                                @for kernel in self.kernels() {
                                    @match case.iter().find(|row| row.kernel == kernel) {
                                        Some(row) => {
                                            @let [wrong, error] = words(row);
                                            @let (open, close) = if is_unpromised(row) { ("(", ")") } else { ("", "") };
                                            td { (open) (wrong) }
                                            td { (error) (close) }
                                        }
                                        None => { td { } td { } }
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Where wrong rays have their place in a panel.
const UPPER: Frame = Frame { left: 56.0, right: 290.0, top: 26.0, bottom: 122.0 };
/// The lower edge of the band below it for none.
const BAND: f64 = 186.0;
/// Where errors have theirs.
const LOWER: Frame = Frame { left: 56.0, right: 290.0, top: 224.0, bottom: 314.0 };

/// Errors below this are not told apart, in u: a result that is stored in `f32` cannot show them. The axis begins there.
const LEAST_ERROR: f64 = 0.11;

/// The axes of all panels.
struct Scales {
    x: Axis,
    wrong: Axis,
    error: Axis,
}

impl Scales {
    fn new(cases: &HardCases) -> Self {
        let ns = cases.costs.iter().map(|cost| cost.ns.median());
        Self {
            x: Axis::logarithmic(ns, UPPER.left + 6.0, UPPER.right - 6.0),
            wrong: Axis::logarithmic(cases.rows.iter().map(wrong), UPPER.bottom - 6.0, UPPER.top),
            error: Axis::logarithmic(
                cases.rows.iter().filter_map(error).map(|u| u.max(LEAST_ERROR)),
                LOWER.bottom,
                LOWER.top,
            ),
        }
    }
}

/// What a row of the table says of a cost.
type Read = fn(&Cost) -> String;

/// The height of a kernel in the band for none: one below the other, as several are as fast and as right.
fn lane(row: &Row) -> f64 {
    let place = KERNELS.iter().position(|kernel| kernel.name() == row.kernel).unwrap_or(0);
    UPPER.bottom + (place as f64 + 0.5) * (BAND - UPPER.bottom) / KERNELS.len() as f64
}

fn mark(row: &Row, x: f64, y: f64, tip: &str) -> Markup {
    let shape = if is_unpromised(row) { "dot hollow" } else { "dot" };
    html! {
        g class=(class(row.kernel)) {
            @if is_trap(row) {
                @let r = 7.5;
                polygon class=(shape) points=(format!("{:.1},{y:.1} {x:.1},{:.1} {:.1},{y:.1} {x:.1},{:.1}", x - r, y - r, x + r, y + r)) {
                    title { (tip) }
                }
            } @else {
                circle class=(shape) cx=(px(x)) cy=(px(y)) r="4.6" { title { (tip) } }
            }
        }
    }
}

/// The colour class of a kernel.
fn class(kernel: &str) -> String {
    format!("c-{kernel}")
}
