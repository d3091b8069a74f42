"use strict";
/* Nodes made with their attributes, put into a parent where one is given, their text set as text, never as markup.
   Before all other scripts. */

function filled(node, attributes, parent, text) {
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  if (parent) parent.append(node);
  return node;
}

const element = (name, attributes = {}, parent = null, text = undefined) => filled(document.createElement(name), attributes, parent, text);
const shape = (name, attributes = {}, parent = null, text = undefined) =>
  filled(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, parent, text);
