/* Boots the page of one hunt. */
(() => {
  const hunt = JSON.parse(document.getElementById("hunt").textContent);
  new Player(document.querySelector("[data-player]"), document).load(hunt);
})();
