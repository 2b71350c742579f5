//! Why nothing came of what was typed.

use onescan_report::{FileError, OutputError};

use crate::browse::BrowseError;
use crate::export::ExportError;
use crate::instrument::InstrumentError;
use crate::map::MapError;
use crate::model::ModelError;
use crate::new::NewError;
use crate::plant::PlantError;
use crate::show::ShowError;
use onescan_edit::edit::EditorError;
use onescan_edit::wiring::WiringError;
use onescan_regress::bisect::BisectError;
use onescan_regress::check::CheckError;
use onescan_regress::diff::DiffError;
use onescan_regress::grade::GradeError;
use onescan_regress::regress::TestError;
use onescan_regress::review::ReviewError;
use onescan_runner::access::AccessError;
use onescan_runner::error::{Usage, sum_of_errors};
use onescan_runner::plc::PlcError;
use onescan_runner::report::ReportError;
use onescan_runner::run::{RunError, SearchError};
use onescan_runner::session::SessionError;
use onescan_runner::shot::ShotError;
use onescan_runner::train::TrainError;
use onescan_runner::view::ViewError;
use onescan_search::campaign::CampaignError;

sum_of_errors! {
    /// Why nothing came of what was typed.
    pub enum CommandError {
        /// `run` or `compare` came to nothing.
        #[diagnostic(transparent)]
        Run(RunError),
        /// `test` came to nothing.
        #[diagnostic(transparent)]
        Test(TestError),
        /// `grade` came to nothing.
        #[diagnostic(transparent)]
        Grade(GradeError),
        /// `campaign` came to nothing.
        #[diagnostic(transparent)]
        Campaign(CampaignError),
        /// `review` came to nothing.
        #[diagnostic(transparent)]
        Review(ReviewError),
        /// `export` came to nothing.
        #[diagnostic(transparent)]
        Export(ExportError),
        /// `diff` came to nothing.
        #[diagnostic(transparent)]
        Diff(DiffError),
        /// `report` came to nothing.
        #[diagnostic(transparent)]
        Report(ReportError),
        /// `view` came to nothing.
        #[diagnostic(transparent)]
        View(ViewError),
        /// `bisect` came to nothing.
        #[diagnostic(transparent)]
        Bisect(BisectError),
        /// `check` or `explain` came to nothing.
        #[diagnostic(transparent)]
        Check(CheckError),
        /// `instrument` came to nothing.
        #[diagnostic(transparent)]
        Instrument(InstrumentError),
        /// `plc` came to nothing.
        #[diagnostic(transparent)]
        Plc(PlcError),
        /// `browse` came to nothing.
        #[diagnostic(transparent)]
        Browse(BrowseError),
        /// `map` came to nothing.
        #[diagnostic(transparent)]
        Map(MapError),
        /// `model` came to nothing.
        #[diagnostic(transparent)]
        Model(ModelError),
        /// `shot` came to nothing.
        #[diagnostic(transparent)]
        Shot(ShotError),
        /// `explore`, `falsify`, `minimise` or `mutate` came to nothing.
        #[diagnostic(transparent)]
        Search(SearchError),
        /// `train` came to nothing.
        #[diagnostic(transparent)]
        Train(TrainError),
        /// `components` or `describe` came to nothing.
        #[diagnostic(transparent)]
        Plant(PlantError),
        /// `wiring` came to nothing.
        #[diagnostic(transparent)]
        Wiring(WiringError),
        /// `show` came to nothing.
        #[diagnostic(transparent)]
        Show(ShowError),
        /// `edit` came to nothing.
        #[diagnostic(transparent)]
        Edit(EditorError),
        /// `new` came to nothing.
        #[diagnostic(transparent)]
        New(NewError),
        /// `join` or `control` came to nothing.
        #[diagnostic(transparent)]
        Session(SessionError),
        /// `token` or `certificate` came to nothing, or nothing can be shown to a session.
        #[diagnostic(transparent)]
        Access(AccessError),
        /// What was typed is wrong.
        #[diagnostic(transparent)]
        Usage(Usage),
        /// A file cannot be written.
        File(FileError),
        /// The report cannot be written.
        Output(OutputError),
    }
}
