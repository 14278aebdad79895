//! Papers and their pages.

use super::folder::{FolderError, Results};
use super::record::Finished;
use super::{hardware, symo, table};
use leastaction_learning::atomic;
use leastaction_plot::PlotError;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A paper.
#[derive(Debug)]
pub struct Paper {
    /// Name on the command line and in files.
    pub name: &'static str,
    /// Title of the page.
    pub title: &'static str,
    /// Meaning of the numbers.
    pub about: &'static str,
    /// Draws pictures of many rows into a folder.
    pub overview: fn(&Path, &[Finished]) -> Result<Vec<Overview>, PlotError>,
}

/// A picture of many rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Overview {
    /// Title of the table that it belongs to.
    pub table: String,
    /// Name of its file.
    pub file: String,
}

/// Paper by Lu et al. 2022.
pub const MODLANET: Paper = Paper {
    name: "modlanet",
    title: "ModLaNet (Lu et al., ICML 2022)",
    about: "Accelerations: mean squared errors on the training and the test set, and relative to the mean squared acceleration. \
            Predictions in the paper's measures, which are not mean squares: A_q and A_E are the Frobenius norm of the errors of \
            positions and energies over the number of comparisons, averaged over the starts; valid: median time until the \
            (wrapped) position is 0.1 off. Pendulums are chaotic: the floor is what exact physics in single precision reaches. What the \
            paper prints of HNN and MLP is not what its authors' program gives on its own data (test MSE, A_q, A_E): three bodies, HNN \
            1.8e-3, 0.153, 0.065; light HNN 1.6e-3, 0.161, 0.043; MLP 2.1e-3, 0.445, 0.314; two pendulums, HNN 4.35 (of the rate of \
            the momenta alone), 2.73, 7.6; light HNN 1.25 (the same), 2.73, 64.7; MLP 22.0, 2.73, 1330.",
    overview: none,
};

/// Paper by Bhattoo et al. 2023.
pub const LGNN: Paper = Paper {
    name: "lgnn",
    title: "LGNN (Bhattoo et al., MLST 2023)",
    about: "Geometric means over starts and times of the rollout error |q' - q| / (|q'| + |q|) and of the energy violation \
            |E' - E| / (|E'| + |E|). The floor is that of exact motion from starts that are off by 1e-8 m. MSE: mean squared \
            error of accelerations. Ours: a simple law (uniform field, polynomial of the squared distance, viscous drag) beside every \
            network; networks alone: without. The paper's numbers were measured with its authors' program on data and truth of its own \
            integrator; ours are on exact motion.",
    overview: none,
};

/// Paper by Santos et al. 2022.
pub const SYMO: Paper = Paper {
    name: "symo",
    title: "SyMo (Santos et al., L4DC 2022)",
    about: "Mean squared errors: test, of positions one step ahead; integration, of positions over 16 free motions of 500 steps, \
            with their median and their first 100 steps; energy along them (J²), the true energy at the model's midpoints, of \
            L-NODE and NODE, which are given the velocities, at its states; inertia matrix at the test positions. The floor is exact \
            physics stepped by the same DEL equation, which a learned Lagrangian can go below. The paper's numbers were measured with \
            its authors' program on equal terms; \
            the acrobot is chaotic, and beyond 100 steps its positions mean nothing.",
    overview: symo::overview,
};

/// Paper by Finzi, Wang and Wilson 2020.
pub const CHNN: Paper = Paper {
    name: "chnn",
    title: "CHNN and CLNN (Finzi et al., NeurIPS 2020): chains of pendulums",
    about: "Chains of 2, 3 and 5 pendulums of random masses and lengths, g = 1, in Cartesian coordinates: 800 training trajectories of \
            5 states (q, v) 0.03 s apart, 100 test starts. Rollout error: geometric mean over starts and 100 steps of \
            |z' - z| / (|z'| + |z|), z = (q, v). The floor is that of exact motion from starts that are off by 1e-8 m. The paper's \
            numbers are those of its best Lagrangian model, CLNN.",
    overview: none,
};

/// Logs of real machines: no paper, but the same kind of tables.
pub const HARDWARE: Paper = Paper {
    name: "hardware",
    title: "Machines of hardware",
    about: "Logs that robots wrote, resampled to 10 ms: a model learns from some and predicts the others, under their torques, over \
            windows of a second, from the state of a quadratic through seven positions. Numbers are the median over windows of the root \
            mean squared error of the joints' positions up to 0.1, 0.5 and 1 s, rad, and its 90th percentile. Windows start every \
            0.25 s from 2 s on, and count where a joint reaches 0.2 rad/s; those of the pendulum only away from upright \
            (cos q ≥ -0.9). As is: nothing of a tested log is used but the start states; calibrated: the zero offsets of its encoders \
            are estimated from its first 2 s. Identified parameters are those that others published for the machine. \
            The arm is judged by torques: mean over joints of the mean squared error over the variance, on motion that was not learned \
            from, and the root mean squared error of each joint.",
    overview: hardware::overview,
};

/// All papers.
pub const PAPERS: [&Paper; 5] = [&MODLANET, &LGNN, &SYMO, &CHNN, &HARDWARE];

fn none(_: &Path, _: &[Finished]) -> Result<Vec<Overview>, PlotError> {
    Ok(Vec::new())
}

/// Reason why a page cannot be written.
#[derive(Debug, Error)]
pub enum PageError {
    /// The results or the page cannot be written.
    #[error(transparent)]
    Results(#[from] FolderError),
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PlotError),
}

impl Paper {
    /// Writes the page, the table as comma-separated values and the results as one JSON file into the folder that
    /// contains the folder of results. Returns the names of the files.
    ///
    /// # Errors
    /// [`PageError`].
    pub fn write(
        &self,
        output: &Path,
        results: &Results,
        finished: &[Finished],
    ) -> Result<[PathBuf; 3], PageError> {
        let overviews = (self.overview)(results.folder(), finished)?;
        let page = table::page(self, finished, results.folder(), &overviews);
        let json = serde_json::to_string_pretty(finished)
            .map_err(|error| FolderError::Content { file: output.to_owned(), error })?;
        let contents = [("html", page), ("csv", table::csv(finished)), ("json", json)];
        let files =
            contents.each_ref().map(|(extension, _)| output.join(format!("{}.{extension}", self.name)));
        for (file, (_, content)) in files.iter().zip(&contents) {
            atomic::write(file, content.as_bytes()).map_err(FolderError::file(file))?;
        }
        Ok(files)
    }
}
