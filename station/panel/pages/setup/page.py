"""The page Setup, with one tab each for login, camera, recipe, masters, users and journal."""

from PySide6.QtWidgets import QTabWidget, QVBoxLayout, QWidget

from station.panel.look.words import translate
from station.panel.pages.page import Page
from station.panel.pages.setup.camera import CameraPage
from station.panel.pages.setup.journal import JournalPage
from station.panel.pages.setup.login import LoginPage
from station.panel.pages.setup.masters import MastersPage
from station.panel.pages.setup.people import PeoplePage
from station.panel.pages.setup.recipe import RecipePage
from station.panel.session.session import Session
from station.panel.widgets.card import scrolled


class SetupPage(Page):
    """Shows the tabs to everybody; each change needs a login of its level."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.tabs = QTabWidget()
        self.login, self.camera, self.recipe = LoginPage(session), CameraPage(session), RecipePage(session)
        self.masters, self.people, self.journal = (
            MastersPage(session),
            PeoplePage(session),
            JournalPage(session),
        )
        for page, name in (
            (self.login, translate("setup", "Login")),
            (self.camera, translate("setup", "Camera")),
            (self.recipe, translate("setup", "Recipe")),
            (self.masters, translate("setup", "Masters")),
            (self.people, translate("setup", "Users")),
            (self.journal, translate("setup", "Journal")),
        ):
            self.tabs.addTab(scrolled(page), name)
        column = QVBoxLayout(self)
        column.addWidget(self.tabs)

    def show_tab(self, page: QWidget) -> None:
        """Show one of the tabs."""
        self.tabs.setCurrentIndex(
            (self.login, self.camera, self.recipe, self.masters, self.people, self.journal).index(page)
        )

    def close_page(self) -> None:
        """Close all tabs."""
        for page in (self.login, self.camera, self.recipe, self.masters, self.people, self.journal):
            page.close_page()
