/* Opens the hunts of the gallery in a dialog. */
(() => {
  const dialog = document.querySelector("[data-dialog]");
  const player = new Player(dialog.querySelector("[data-player]"), dialog);
  const open = (button) => {
    const hunt = JSON.parse(document.getElementById(button.dataset.hunt).textContent);
    dialog.querySelector("[data-title]").textContent = `${hunt.title}, run ${hunt.run}: ${hunt.outcome}`;
    dialog.querySelector("[data-command]").textContent = hunt.command;
    dialog.showModal();
    player.load(hunt);
    player.parts.play.focus({ preventScroll: true });
    dialog.scrollTop = 0;
  };
  for (const button of document.querySelectorAll("[data-hunt]")) button.addEventListener("click", () => open(button));
  dialog.querySelector("[data-close]").addEventListener("click", () => dialog.close());
  dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
  dialog.addEventListener("close", () => player.pause());
})();
