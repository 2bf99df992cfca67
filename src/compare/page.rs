//! A comparison as a page: one HTML file that needs nothing else.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{Markup, PreEscaped, html};

use super::heatmap::pixel_heat;
use super::{
    Band, BySphere, Difference, Explanation, Metrics, PIXELS_PER_DEGREE, SCALE, SSIM_WINDOW, SizeMismatch, Widths,
    heatmap, level, value, worst_places,
};
use crate::film::{Picture, encode_png};
use crate::mistakes::{CUT_SHORT, Cause, Diagnosis, Example, Role};
use crate::report::number::short;
use crate::report::page;
use crate::scene::Names;
use crate::words::{count, visible};

/// Places that are shown enlarged.
const PLACES: usize = 20;
/// Pixels on a side of an enlarged place; report.css enlarges each 16 times.
const SIDE: u32 = 9;

/// Two pictures of one size, with all that is known of their difference.
pub struct Comparison<'a> {
    /// What the page is about.
    pub title: &'a str,
    /// What A and B are called.
    pub names: [&'a str; 2],
    /// A and B; with a scene B is the reference.
    pub pictures: [&'a Picture; 2],
    /// How they differ.
    pub difference: &'a Difference,
    /// The verdict in words.
    pub verdict: &'a str,
    /// What rounding explains of it, with a scene.
    pub explanation: Option<&'a Explanation>,
    /// Which mistake explains it, where that was asked for.
    pub diagnosis: Option<&'a Diagnosis>,
    /// What the differing pixels show, with the labels of the scene's spheres.
    pub spheres: Option<(&'a BySphere, &'a Names)>,
    /// What had to be got over in reading the pictures.
    pub remarks: &'a [String],
}

impl Comparison<'_> {
    /// The page; `command` is what made it.
    ///
    /// # Errors
    /// Pictures of different sizes.
    pub fn html(&self, command: &str) -> Result<String, SizeMismatch> {
        let [a, b] = self.pictures;
        let about = format!("A: {}. B: {}", visible(self.names[0]), visible(self.names[1]));
        let content = html! {
            (self.summary(&Metrics::between(a, b)?))
            (self.viewer(&heatmap(a, b)?, Band::counts(a, b)?))
            @if let Some(diagnosis) = self.diagnosis { (causes(diagnosis)) }
            @if let Some(explanation) = self.explanation { (decisions(explanation)) }
            @if let Some((by_sphere, names)) = self.spheres { (spheres(by_sphere, names)) }
            (self.places(&worst_places(a, b, PLACES)?))
            script { (PreEscaped(include_str!("page.js"))) }
        };
        Ok(page(self.title, &about, command, &content, &method()))
    }

    fn summary(&self, metrics: &Metrics) -> Markup {
        let Difference { width, height, pixels, mean, .. } = self.difference;
        let Metrics { rmse, psnr, ssim, flip, level_p50, level_p95, level_p99, level_max } = metrics;
        html! {
            dl {
                dt { "Verdict" } dd { b { (self.verdict) } }
                dt { "Size" } dd { (width) " × " (height) ", " (count(*pixels, "pixel")) }
                @for (threshold, differing) in self.difference.differing.by_threshold() {
                    dt { "Differ by > " (threshold) }
                    dd { (differing) " (" (short(100.0 * differing as f64 / *pixels as f64)) " %)" }
                }
                dt { "RMSE" } dd { (short(*rmse)) " levels; mean " (short(*mean)) }
                dt { "PSNR" } dd { @if psnr.is_finite() { (format!("{psnr:.2} dB")) } @else { "infinite" } }
                dt { "SSIM" }
                dd { @match ssim { Some(ssim) => (format!("{ssim:.5}")), None => "the pictures are too small for it" } }
                dt { "FLIP" } dd { (format!("{flip:.5}")) }
                dt { "Level difference" }
                dd { "median " (level_p50) ", p95 " (level_p95) ", p99 " (level_p99) ", greatest " (level_max) }
                @for note in &self.difference.resemblances { dt { "Note" } dd { (note.to_string()) } }
                @for remark in self.remarks { dt { "Note" } dd { (visible(remark)) } }
            }
        }
    }

    /// A over B, of which a slider shows more or less, or both in turn, or the heat map.
    fn viewer(&self, heat: &Picture, bands: [u64; SCALE.len()]) -> Markup {
        let [a, b] = self.pictures;
        let (width, height) = (a.width(), a.height());
        let picture = |class: &str, alt: &str, picture: &Picture| {
            html! { img class=(class) alt=(alt) width=(width) height=(height) src=(data_uri(picture)); }
        };
        html! {
            h2 { "Pictures" }
            figure.viewer data-show="slider" style=(format!("--ratio: {width} / {height}; --width: {width}")) {
                fieldset.modes {
                    legend.small { "Show" }
                    @for (mode, label) in
                        [("slider", "Slider"), ("blink", "Blink"), ("a", "A"), ("b", "B"), ("heat", "Heat map")]
                    {
                        label { input type="radio" name="show" value=(mode) checked[mode == "slider"]; " " (label) }
                    }
                }
                div.stack {
                    (picture("b", "picture B", b))
                    (picture("a", "picture A", a))
                    (picture("heat", "the heat map of their difference", heat))
                }
                input.split type="range" min="0" max="100" value="50" aria-label="how much of A is shown";
                figcaption {
                    "Left of the slider A, right of it B. Arrow keys move the slider and go from one view to the next."
                }
                ul.legend.small {
                    @for (Band { color, legend, .. }, pixels) in SCALE.iter().zip(bands) {
                        li { (swatch(*color)) " " (legend) " (" (pixels) ")" }
                    }
                }
            }
        }
    }

    fn places(&self, places: &[[u32; 2]]) -> Markup {
        html! {
            h2 { "Worst places" }
            @if places.is_empty() {
                p { "No pixel differs." }
            } @else {
                p {
                    "The greatest differences, A on the left and B on the right, 16 times enlarged, then the heat of their \
                     difference. The frame is around the pixel."
                }
                div.places { @for &place in places { (self.place(place)) } }
            }
        }
    }

    fn place(&self, [x, y]: [u32; 2]) -> Markup {
        let [a, b] = self.pictures;
        let [left, top] = [(x, a.width()), (y, a.height())].map(|(at, size)| {
            let last = size.saturating_sub(SIDE);
            at.saturating_sub(SIDE / 2).min(last)
        });
        let [width, height] = [SIDE.min(a.width()), SIDE.min(a.height())];
        let crop = |pixel: &dyn Fn(u32, u32) -> [u8; 3]| {
            let rows = (top..top + height).flat_map(|y| (left..left + width).map(move |x| (x, y)));
            Picture::assemble(width, height, rows.flat_map(|(x, y)| pixel(x, y)).collect())
        };
        let heat = crop(&|x, y| pixel_heat(a.pixel(x, y), b.pixel(x, y)));
        let frame = format!("--x: {}; --y: {}; --columns: {width}; --rows: {height}", x - left, y - top);
        let [value_a, value_b] = [a.pixel(x, y), b.pixel(x, y)];
        let is_unexplained = self
            .explanation
            .map(|explanation| explanation.places.binary_search_by_key(&(y, x), |&[x, y]| (y, x)).is_ok());
        html! {
            figure style=(frame) {
                div.crops {
                    @for (name, picture) in
                        [("A", crop(&|x, y| a.pixel(x, y))), ("B", crop(&|x, y| b.pixel(x, y))), ("heat", heat)]
                    {
                        span.crop { img alt=(format!("{name} around x {x}, y {y}")) src=(data_uri(&picture)); }
                    }
                }
                figcaption {
                    b { "x " (x) ", y " (y) } ", " (count(level(value_a, value_b), "level"))
                    @match is_unexplained {
                        Some(true) => ", unexplained",
                        Some(false) => ", explained by rounding",
                        None => "",
                    }
                    br;
                    (swatch(value_a)) " A " (value(value_a)) br;
                    (swatch(value_b)) " B " (value(value_b))
                }
            }
        }
    }
}

fn causes(diagnosis: &Diagnosis) -> Markup {
    let Diagnosis { causes, to_explain, left, cut_short } = diagnosis;
    html! {
        h2 { "Likely cause" }
        @if causes.is_empty() {
            p { "No cause: " (diagnosis.without_causes()) "." }
        } @else {
            ul {
                @for cause in causes { li { (one_cause(cause)) } }
            }
            p.small { "Of " (count(*to_explain, "pixel")) " the causes leave " (left) "." }
            @if *cut_short { p { "They are the best that were found: " (CUT_SHORT) "." } }
        }
    }
}

fn one_cause(cause: &Cause) -> Markup {
    let Cause { name, share, role, detail, examples } = cause;
    html! {
        b { (name) } ", " (format!("{:.1}", 100.0 * share)) " %"
        @match role { Role::Cause => "", Role::Equal => " (just as well)", Role::Lesser => " (less well)" }
        ": " (visible(detail))
        @for Example { x, y, value: shown, reference, explained } in examples {
            br;
            span.small {
                "x " (x) ", y " (y) ": " (swatch(*shown)) " " (value(*shown)) ", right is " (swatch(*reference)) " "
                (value(*reference)) ", with it " (swatch(*explained)) " " (value(*explained))
            }
        }
    }
}

fn decisions(explanation: &Explanation) -> Markup {
    html! {
        h2 { "Pixels by decision" }
        p { "By which decision each pixel that differs is explained: rounding can turn it, and turned it gives what A has." }
        dl {
            dt { "Judged as" } dd { (explanation.judged_as.to_string()) }
            dt { "Differing" } dd { (explanation.differing) }
            @for (decision, pixels) in &explanation.explained { dt { (decision.name()) } dd { (pixels) } }
            @if let Some(Widths { median, greatest }) = explanation.widths {
                dt { "Margins" } dd { (format!("{median:.1e} levels in the median, {greatest:.1e} at most")) }
            }
            dt { "Unexplained" } dd { b { (explanation.unexplained) } }
            @if explanation.unexplained > 0 {
                dt { "Proven" } dd { (explanation.proven) " " (explanation.proven_in_words()) }
            }
            @if explanation.undecided > 0 {
                dt { "Undecided" } dd { (explanation.undecided) " of them have more paths than are tried" }
            }
        }
    }
}

fn spheres(by_sphere: &BySphere, names: &Names) -> Markup {
    let BySphere { counts, step } = by_sphere;
    let (shown, rest) = counts.split_at(counts.len().min(PLACES));
    html! {
        h2 { "Pixels by sphere" }
        p {
            "What the differing pixels show in the reference's picture."
            @if *step > 1 { " There are many: one in " (step) " is counted." }
        }
        div.wide tabindex="0" role="region" aria-label="pixels by sphere" {
            table {
                tr { th { "shows" } th { "differ" } th { "unexplained" } }
                @for on in shown {
                    tr {
                        td { (on.sphere.map_or_else(|| "background".into(), |index| names.in_words("sphere", index))) }
                        td { (on.differing) }
                        td { (on.unexplained) }
                    }
                }
            }
        }
        @if !rest.is_empty() { p.small { "And " (count(rest.len() as u64, "other")) " with fewer." } }
    }
}

fn method() -> Markup {
    html! {
        p {
            "The level difference of two pixels is the greatest over their three channels. RMSE is over all samples; PSNR is \
             20 log₁₀(255 / RMSE). Percentiles are of the level differences of all pixels."
        }
        p {
            "SSIM is the mean over all windows of " (SSIM_WINDOW) " × " (SSIM_WINDOW) " pixels within the picture, Gaussian \
             with σ = 1.5, K₁ = 0.01, K₂ = 0.03, of Rec. 601’s luma: Wang, Bovik, Sheikh and Simoncelli, IEEE Transactions on \
             Image Processing 13 (2004)."
        }
        p {
            "FLIP is the mean of what is seen when the pictures alternate, 0 to 1, at " (PIXELS_PER_DEGREE) " pixels a degree: \
             Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, Proceedings of the ACM on Computer Graphics \
             and Interactive Techniques 3 (2020)."
        }
    }
}

fn swatch([red, green, blue]: [u8; 3]) -> Markup {
    html! { span.swatch style=(format!("background: rgb({red} {green} {blue})")) {} }
}

/// The picture as a PNG in a URI.
fn data_uri(picture: &Picture) -> String {
    // Memory takes whatever is written.
    let png = encode_png(picture.width(), picture.height(), picture.rgb()).unwrap_or_default();
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}
