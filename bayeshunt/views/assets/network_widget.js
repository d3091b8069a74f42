/* The widget of a network: what is set in the picture is told to Python, and the other way round. */
function render({ model, el }) {
  const names = ["evidence", "likelihood", "asked"];
  const root = document.createElement("div");
  el.append(root);
  const view = new NetworkView(root, model.get("_data"), (...values) => {
    names.forEach((name, i) => model.set(name, values[i]));
    model.save_changes();
  });
  const follow = () => view.set(...names.map((name) => model.get(name)));
  for (const name of names) model.on(`change:${name}`, follow);
  follow();
  return () => names.forEach((name) => model.off(`change:${name}`, follow));
}

export default { render };
